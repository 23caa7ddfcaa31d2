#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "dataset/dataset.h"
#include "lamps/light_stack.h"

namespace radiafit::tools {

/// The images of a dataset over a grid, whose light moves: means of blocks of pixels over their lamps' intensities,
/// 96 at most along the longer side. What is clipped is left out.
LightStack light_stack(const Dataset& dataset);

/// What the images say against their light file, and what helps, in one line: other axes, or another order of the
/// images. file: for the words; named: its lines name the images; axes: by which it was read
/// (LightImportOptions::light_axes). None: they suit, or the images cannot tell.
std::optional<std::string> light_doubt(const Dataset& dataset, const std::filesystem::path& file, bool named,
                                       const std::string& axes);

}  // namespace radiafit::tools
