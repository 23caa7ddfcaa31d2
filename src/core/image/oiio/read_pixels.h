#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "image/image_header.h"
#include "image/raw_image.h"

/// The one function of the module radiafit_oiio, which links OpenImageIO. That library brings 240 others along; so the
/// module is loaded when the first JPEG, TIFF or OpenEXR picture is read (oiio_image.cpp), not with every program.
namespace radiafit {

struct OiioPixels {
    RawImage image;
    std::optional<std::string> damage;  ///< the data are no picture, or another one than the header describes: why
    std::string channel_type;           ///< the type of channels that are neither 8 or 16 bits nor floats, or empty
    std::string failure;                ///< what is wrong with OpenImageIO itself, or empty
};

/// `name` is only passed on to OpenImageIO; `header` is what read_image_header found in the same bytes; `reader`: by
/// which name OpenImageIO knows the format. Throws nothing of ours.
using ReadOiioPixels = void(const std::string& name, std::string_view bytes, const ImageHeader& header,
                            const char* reader, OiioPixels& out);

inline constexpr const char* oiio_module = "radiafit_oiio.so";
inline constexpr const char* oiio_function = "radiafit_read_oiio_pixels";

}  // namespace radiafit
