#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "image/color_tags.h"

namespace radiafit {

/// A photograph as stored: row 0 on top, three channels. Grey files are spread over the three.
struct ImageFile {
    int width = 0, height = 0;    ///< pixels
    int bits = 8;                 ///< per channel: 8, 16 or 32 (floats)
    bool linear = false;          ///< 16 bits only: the file says that its values are linear; else they are sRGB
    std::vector<uint8_t> rgb8;    ///< [height][width][3] if bits == 8
    std::vector<uint16_t> rgb16;  ///< [height][width][3] if bits == 16
    std::vector<float> rgb32;     ///< [height][width][3] if bits == 32; as stored, not finite values too
    std::vector<uint8_t> alpha;   ///< [height][width], 0 to 255; empty if the file has none
    bool grey = false;            ///< the file has one colour channel
    const char* format = "";      ///< PNG, JPEG, ...
    int orientation = 1;          ///< EXIF's (image/orientation.h), not applied
    ColorTags colors = {};        ///< what the file says of its colours, not applied
    std::vector<std::string> remarks = {};  ///< what of the file is left out or filled up, a few words each
};

/// Called with a picture's size in pixels before memory is taken for them: the place to throw for another than
/// expected.
using HeaderCheck = std::function<void(int width, int height)>;

/// Reads the formats of image_format.h, recognized by their content. Colours are never multiplied by alpha. Pixels
/// are as stored: colour profiles and EXIF's orientation are told and not applied. `floats`: halves and floats (EXR,
/// PFM, TIFF) are taken too. Throws UserError that names file and cure: missing, another format, truncated or corrupt,
/// larger than image/image_header.h allows, neither 8 nor 16 bits, neither grey nor RGB.
ImageFile read_image(const std::filesystem::path& file, bool floats = false, const HeaderCheck& check = {});
/// The same of a picture that lies in memory, a part of `file`; without floats.
ImageFile decode_image(const std::filesystem::path& file, std::string bytes, const HeaderCheck& check = {});

/// A mask [height][width], 255 = object, 0 = not: of values from 0 to 255, 128 or more. Where no value is so large and
/// there are at most 16, so that they number what is seen (labels), whatever is not 0; a lossy format has no labels.
/// 16-bit files without a value above 255 count as 8-bit ones.
struct MaskFile {
    int width = 0, height = 0;
    std::vector<uint8_t> values;
    int largest = 0;      ///< of the values in the file, from 0 to 255
    bool labels = false;  ///< values above 1 that number what is seen
};
MaskFile read_mask(const std::filesystem::path& file, const HeaderCheck& check = {});

}  // namespace radiafit
