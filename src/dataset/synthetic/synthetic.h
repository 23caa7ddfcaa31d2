#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

/// Seeded datasets of known making: stand-ins for the paper's captures, which are not public. A textured, glossy solid
/// under several lights with shadows: nothing that a light field map represents exactly.
namespace radiafit {

struct SyntheticOptions {
    std::string shape = "star";   ///< "star" or "bust"
    std::string scale = "smoke";  ///< "smoke", "standard" or "paper": triangles, images and pixels as in claims.md
    uint64_t seed = 1;
};

/// What a shape has at a scale.
struct SyntheticSize {
    int triangles = 0;  ///< even: the mesh is closed
    int views = 0;      ///< every eighth is held out
    int side = 0;       ///< images are side x side pixels
};
/// Throws UserError, with the names there are, for an unknown shape or scale.
SyntheticSize synthetic_size(const SyntheticOptions& options);

/// Writes a packed dataset (u8-srgb, no masks: the mesh covers the object). The same options give the same bytes, for
/// any number of threads. Throws UserError for unknown names and for an output that cannot be written.
void generate_synthetic(const SyntheticOptions& options, const std::filesystem::path& out);

/// The Dataset::source that generate_synthetic() writes: tells whether a dataset at hand is what it would make today.
std::string synthetic_source(const SyntheticOptions& options);

}  // namespace radiafit
