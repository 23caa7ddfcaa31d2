#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "image/color_tags.h"
#include "image/raw_image.h"

/// The one function of the module radiafit_heif, which links libheif. That library brings decoders of three video
/// formats along; so the module is loaded when the first HEIF picture is read (heif_image.cpp), not with every program.
namespace radiafit {

/// A HEIF file's primary picture, upright: the file's rotations, mirrors and crops are applied.
struct HeifPicture {
    uint64_t width = 0, height = 0;  ///< pixels
    int bits = 8;                    ///< of a channel as stored; above 8 the image has 16, spread over their range
    bool alpha = false;
    std::string profile;  ///< the bytes of its ICC profile, of which none are read beyond largest_profile; or empty
    bool profile_unreadable = false;      ///< there is one
    std::optional<ColorNumbers> numbers;  ///< of a file without a profile
    RawImage image;                       ///< if asked for
    std::string other;                    ///< why it is of a kind that is not read, or empty
    std::string damage;                   ///< what is wrong with the file, or empty
};

/// The picture's description, taken from the file's boxes; `pixels`: and its pixels, decoded. Throws nothing of ours.
using ReadHeif = void(std::string_view bytes, bool pixels, HeifPicture& out);

inline constexpr const char* heif_module = "radiafit_heif.so";
inline constexpr const char* heif_function = "radiafit_read_heif";

}  // namespace radiafit
