#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/picture_facts.h"
#include "image/image_file.h"

/// A calibrated photograph's file and its mask's: read, in sRGB's colours, turned as the calibration has it.
namespace radiafit::tools {

/// What the calibration says of a photograph, and the user of EXIF.
struct PhotographSource {
    std::string name;                   ///< for messages
    std::filesystem::path image, mask;  ///< mask: empty if there is none
    bool inverted_mask = false;         ///< black = object
    int width = 0, height = 0;          ///< pixels that the photograph is to have
    std::array<int, 2> full_size = {};  ///< width and height that a mask may have in place of these
    std::string exif_orientation;       ///< auto, stored or apply (ImportOptions::exif_orientation)
    std::string expected_by;            ///< "cameras.bin calibrates": what says the size
    std::string size_cure;              ///< what to do about another size
};

struct PhotographFile {
    ImageFile image;  ///< width x height
    MaskFile mask;    ///< turned along; without values: there is none
    PictureFacts facts;
};

/// Colours as convert_colors() leaves them; where nothing is said of them they are sRGB, and floats linear. A mask of
/// the size that the photograph has as stored is turned along with it. Throws UserError for other sizes
/// than these, and for a float that is not finite where neither mask nor alpha leaves it out.
PhotographFile read_photograph_file(const PhotographSource& source);

}  // namespace radiafit::tools
