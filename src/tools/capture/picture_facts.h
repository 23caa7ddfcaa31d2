#pragma once
#include <span>
#include <string>
#include <vector>

#include "capture/picture_colors.h"
#include "image/image_file.h"

/// What is said of how pictures were read: once for all that are alike.
namespace radiafit::tools {

struct PictureFacts {
    std::string name;                  ///< of the picture, for messages
    std::string colors;                ///< how its values are taken, and why: one line, or empty
    std::string ignored;               ///< what its file says of colours and is not used, or empty
    std::vector<std::string> remarks;  ///< what of the file is left out or filled up
    int orientation = 1;               ///< EXIF's
    bool turned = false;               ///< as EXIF says
};

/// Of an image, by what convert_colors() found. unknown_is_linear: how values are taken of which the file says nothing.
PictureFacts facts_of(std::string name, const ImageFile& image, const ColorReading& colors, bool unknown_is_linear);

struct PictureWords {
    std::vector<std::string> notes;    ///< what the user should know
    std::vector<std::string> remarks;  ///< what he may want to know
};

/// One line for all that are alike, with their number and an example where others differ. orientation_cure: what to do
/// where photographs whose EXIF orientations differ are taken as stored.
PictureWords describe_pictures(std::span<const PictureFacts> pictures, const std::string& orientation_cure);

}  // namespace radiafit::tools
