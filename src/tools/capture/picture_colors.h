#pragma once
#include <string>

#include "image/image_file.h"

/// Pictures in other colours than sRGB's, by what their files say: ICC profiles, PNG's chunks, OpenEXR's
/// chromaticities.
namespace radiafit::tools {

/// How a picture's values are to be taken.
struct ColorReading {
    enum class Kind {
        unknown,    ///< the file says nothing that could be used
        srgb,       ///< as stored, the values are sRGB
        linear,     ///< as stored, the values are linear light of sRGB's primaries
        converted,  ///< they are now: 8 bits sRGB, else linear light
    };
    Kind kind = Kind::unknown;
    std::string by;       ///< what says so, such as "profile 'Display P3'"
    std::string ignored;  ///< what the file says and why it is not used; empty: nothing is left out
};

/// Takes a picture's colours by ImageFile::colors: values within 1.5 / 255 of sRGB (9 / 255 where the profile calls
/// itself sRGB, which allows for a power of 2.2), or of linear light, stay as they are to the bit; others are converted
/// to sRGB's primaries, where what sRGB cannot show is clipped (not of floats). Sets ImageFile::linear, unless the kind
/// is unknown. Floats are always linear: of a profile, its primaries count alone.
ColorReading convert_colors(ImageFile& image);

}  // namespace radiafit::tools
