#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

inline constexpr size_t largest_profile = size_t(4) << 20;  ///< bytes; beyond any profile of a camera or a screen

/// What a picture's file says of its colours. read_image() applies nothing of it: capture/picture_colors.h does.
struct ColorTags {
    std::string profile;  ///< the bytes of an ICC profile, not looked into yet; empty: none
    std::string damage;   ///< why a profile that the file announces cannot be taken out of it; empty: nothing is wrong
    std::string srgb;     ///< what says that values are sRGB, such as "the chunk sRGB"; empty: nothing
    /// PNG's chunk gAMA, or what HEIF or EXIF say: the stored value is light to this power; 0: none.
    double gamma = 0;
    /// x and y of red, green, blue and white (PNG's cHRM, an EXR's attribute, HEIF's or EXIF's); all 0: none.
    std::array<double, 8> chromaticities = {};
    std::string numbers_by;  ///< what says gamma and chromaticities, where PNG's chunks do not

    bool has_chromaticities() const { return chromaticities != std::array<double, 8>{}; }
    bool has_profile() const { return !profile.empty() || !damage.empty(); }
};

/// Puts a JPEG's pieces of a profile together: the contents of its APP2 segments behind "ICC_PROFILE\0", in the order
/// of the file. Source: ICC.1:2010, B.4.
void join_profile(const std::vector<std::string_view>& pieces, ColorTags& tags);

/// A PNG's compressed profile: the content of its iCCP chunk. Source: PNG specification, 11.3.3.3.
void unpack_profile(std::string_view chunk, ColorTags& tags);

/// A profile as it stands in the file.
void take_profile(std::string_view bytes, ColorTags& tags);

}  // namespace radiafit
