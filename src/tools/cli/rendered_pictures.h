#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "dataset/dataset.h"
#include "eval/contestant.h"

namespace radiafit::tools {

/// Another program's pictures as a contestant: of each view the picture of the same name in `folder`, whatever its
/// ending (ImageFinder's rules; of several the .exr), or of the name that `radiafit render` gives, and of the size of
/// the view or of the whole photograph that it is a rectangle of; in the photograph's exposure. Values of 8 and 16 bits
/// are sRGB unless the file says otherwise, floats linear light; where there is an alpha channel, float colours are
/// multiplied by it, as OpenEXR has them, and others are not. Only the pixels that the judge compares are looked at, so
/// that backgrounds are all the same. For judge() with one point a pixel.
///
/// All pictures are read at once. Throws UserError for one that is missing, or of another size. The dataset must
/// outlive the contestant.
Contestant pictures_as_contestant(const Dataset& dataset, const std::vector<uint32_t>& views,
                                  const std::filesystem::path& folder);

}  // namespace radiafit::tools
