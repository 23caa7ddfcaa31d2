#pragma once
#include <array>
#include <cstdint>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

/// What decides about the memory that an OpenEXR file asks for.
struct ExrHeader {
    bool plain = true;              ///< one picture, not several or deep ones; of others, nothing else is known
    bool sized = false;             ///< it has a data window
    int64_t width = 0, height = 0;  ///< pixels of that; below 1 where its corners are swapped
    uint64_t bits_per_pixel = 0;    ///< all channels together
    uint64_t tile = 0;              ///< the longer side of a tile, in pixels, or 0
    std::vector<std::string> channels = {};    ///< their names
    bool subsampled = false;                   ///< a channel has fewer pixels than the picture
    std::array<int32_t, 4> data = {};          ///< the data window: left, top, right, bottom, all within it
    std::array<int32_t, 4> display = {};       ///< the display window; where the file has none, the data window
    std::array<float, 8> chromaticities = {};  ///< x and y of red, green, blue, white; 0: the file has none
};

/// Walks the attributes of an OpenEXR file of `bytes` bytes, from its beginning. OpenEXR takes the memory that
/// attributes, tiles and lines claim to need before it finds the file shorter, and before anyone may ask how large the
/// picture is. Throws std::runtime_error, whose text says in a few words what is damaged.
ExrHeader walk_exr_header(std::istream& in, uint64_t bytes);

/// Whether the value of an attribute in an OpenEXR header has the length that its type and its content imply. OpenEXR
/// reads values of most types without regard to the length before them: where the two disagree, it takes what follows
/// for another attribute than one who steps from length to length. True of types that it does not know.
/// Source: OpenEXR File Layout, "Attribute types".
bool exr_attribute_fits(std::string_view type, std::string_view value);

}  // namespace radiafit
