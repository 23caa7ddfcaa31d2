#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

/// What EXIF data say, which are laid out as a TIFF is, and what TIFFs and BigTIFFs themselves say alike.
namespace radiafit {

/// The value of one entry in the first directory of a TIFF or BigTIFF, which is what EXIF data are, too.
struct TiffValue {
    std::string_view bytes;  ///< of all its numbers
    int size = 1;            ///< bytes of a number
    bool big_endian = false;
};

/// Nothing where there is no such entry, or it lies beyond the end: of what the pixels do not need, damage is no
/// reason to refuse a picture. `directory`: where another one than the first begins.
std::optional<TiffValue> find_tiff_value(std::string_view tiff, uint16_t tag, std::optional<uint64_t> directory = {});

/// The orientation in a TIFF's first directory; 1 where it says nothing, or nothing that exists.
int tiff_orientation(std::string_view tiff);

/// An entry's fractions, as TIFF writes chromaticities; empty where there is none, or it holds something else.
std::vector<double> tiff_fractions(std::string_view tiff, uint16_t tag);

/// Whether EXIF data say that colours are Adobe RGB (1998): interoperability index R03. Source: EXIF 2.32, 4.6.7;
/// DCF 2.0.
bool exif_says_adobe_rgb(std::string_view exif);

}  // namespace radiafit
