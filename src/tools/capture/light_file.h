#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/linear.h"

/// Text files that say how the images of a capture were lit. Numbers in a line are separated by blanks or commas; #
/// begins a comment line. Every reader throws UserError that names file and line: missing, malformed, not finite.
namespace radiafit::tools {

struct LightFile {
    std::vector<std::string> names;  ///< images in the file's order; only an .lp file has them
    std::vector<Vec3d> vectors;      ///< as written: directions to the lamps, of any length above 0, or their places
};

/// By the name's ending: an RTI light file (.lp: the number of images, then an image's name, which may hold blanks, and
/// a vector per line) or three numbers per line. Throws UserError also for a zero vector, an image named twice, and
/// an .lp file with another number of lines than it says.
LightFile read_lights(const std::filesystem::path& file);

/// Whether a file of this name says which image each light is of.
bool names_images(const std::filesystem::path& file);

/// Three numbers per line; `what` names their role, such as "camera position".
std::vector<Vec3d> read_vectors(const std::filesystem::path& file, const std::string& what);

/// Linear red, green and blue per line, or one number for the three; not below 0 and not all 0.
std::vector<Vec3d> read_intensities(const std::filesystem::path& file);

/// Circles in pictures of such a size: x and y of the centre and the radius per line, pixels from the top left corner,
/// x to the right and y down. Throws UserError also for none, for one outside the picture, and for two that overlap.
std::vector<Vec3d> read_circles(const std::filesystem::path& file, int width, int height);
inline constexpr int most_spheres = 20;

/// One name per line, none twice.
std::vector<std::string> read_names(const std::filesystem::path& file);

}  // namespace radiafit::tools
