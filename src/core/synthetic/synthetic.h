#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "base/resources.h"
#include "synthetic/ornament_options.h"

/// Seeded datasets of known making: stand-ins for the paper's captures, which are not public. Star and bust: a
/// textured, glossy solid under several lights with shadows: nothing that a light field map represents exactly.
/// Ornament: three reflectances under a lamp that moves (ornament.h).
namespace radiafit {

struct SyntheticOptions {
    std::string shape = "star";  ///< "star", "bust" or "ornament"
    std::string scale =
        "smoke";  ///< "smoke", "standard" or "paper": what it has of triangles and images, see SyntheticSize
    uint64_t seed = 1;
    OrnamentOptions ornament = {};  ///< refused for another shape
    int subdivide = 1;              ///< each triangle in n x n equal ones: the same surface; refused for the ornament
    int views = 0;                  ///< so many images in place of the scale's; 0: these
};

/// What a shape has at a scale.
struct SyntheticSize {
    int triangles = 0;     ///< even: the mesh is closed
    int views = 0;         ///< every eighth is held out
    int side = 0;          ///< images are side x side pixels
    int surface_side = 0;  ///< ornament: of the texels that its truth is given for
};
/// Throws UserError, with the names there are, for an unknown shape or scale.
SyntheticSize synthetic_size(const SyntheticOptions& options);

/// Upper bounds of what generate_synthetic() will take. Throws UserError for an unknown shape or scale.
Needs synthetic_needs(const SyntheticOptions& options);

/// A synthetic dataset's image i: its name, and whether it is held out.
View synthetic_view(size_t i, const Camera& camera);

/// Writes a packed dataset (star and bust: u8-srgb; no masks: the mesh covers the object). The same options give the
/// same bytes, for any number of threads. Throws UserError for unknown names and for an output that cannot be written.
void generate_synthetic(const SyntheticOptions& options, const std::filesystem::path& out);

/// The Dataset::source that generate_synthetic() writes: a dataset that has it is what it would make today.
std::string synthetic_source(const SyntheticOptions& options);

}  // namespace radiafit
