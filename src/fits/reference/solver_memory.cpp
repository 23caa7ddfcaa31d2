#include "reference/solver_memory.h"

#include <algorithm>

#include "reference/half_step.h"

namespace radiafit::fits {
namespace {

constexpr uint64_t lanes = sizeof(Lanes<double>);

/// One vertex's numbers, as the solvers count them.
struct Sizes {
    MapNeighbours tile, view;
    Smoothness smooth_tile, smooth_view;
    uint64_t maps, samples, terms;
    uint64_t surface_texels, view_texels;  ///< of one map each
    uint64_t surface, view_map;            ///< parameters of one surface map, and of the view map

    Sizes(const LfmOptions& model, const VertexShape& vertex)
        : tile(MapNeighbours::triangle(model.surface_side)),
          view(MapNeighbours::square(model.view_side)),
          smooth_tile(tile),
          smooth_view(view),
          maps(vertex.maps),
          samples(vertex.samples),
          terms(uint64_t(model.terms)),
          surface_texels(tile.texel_count()),
          view_texels(view.texel_count()),
          surface(surface_texels * terms),
          view_map(view_texels * terms) {}
    uint64_t parameters() const { return maps * surface + view_map; }
};

/// LaneCholesky, with the columns that it factors by.
uint64_t cholesky_bytes(uint64_t size, uint64_t band) {
    const uint64_t within = std::min(band, size - 1);
    return lanes * (size * (within + 1) - within * (within + 1) / 2 + 4 * size) + 8 * size;
}
uint64_t half_step_bytes(uint64_t size, uint64_t band) { return 2 * cholesky_bytes(size, band) + 4 * size * lanes; }

uint64_t surface_step_bytes(const LfmOptions& model, const Sizes& s) {
    const uint64_t band = surface_band(model, s.smooth_tile);
    // and a matrix that was freed: the allocator gives such back in some runs, and in others keeps them
    return s.maps * half_step_bytes(s.surface, band) + cholesky_bytes(s.surface, band) +
           s.surface_texels * (s.terms * (s.terms + 1) / 2 + s.terms) * lanes;
}

/// Doubles in the Jacobian's blocks of penalties of one map whose texels are blocks of parameters.
uint64_t penalty_doubles(const MapNeighbours& map, uint64_t terms) {
    uint64_t blocks = 0;
    for (size_t i = 0; i < map.texel_count(); ++i) blocks += 1 + map.of(i).size();
    return blocks * terms * (terms + 1);
}

}  // namespace

uint64_t als_bytes(const LfmOptions& model, const VertexShape& vertex) {
    const Sizes s(model, vertex);
    return surface_step_bytes(model, s) + half_step_bytes(s.view_map, view_band(model, s.smooth_view)) +
           2 * s.parameters() * lanes;
}

uint64_t varpro_bytes(const LfmOptions& model, const VertexShape& vertex) {
    const Sizes s(model, vertex);
    const uint64_t columns = s.view_map + 16;  // rounded up to whole registers
    const uint64_t schur = (s.surface + columns) * columns * sizeof(Lanes<float>);
    return surface_step_bytes(model, s) + half_step_bytes(s.view_map, s.view_map) +
           cholesky_bytes(s.view_map, view_band(model, s.smooth_view)) + schur + 2 * s.parameters() * lanes;
}

uint64_t ceres_bytes(const LfmOptions& model, const VertexShape& vertex, CeresMemory memory) {
    const Sizes s(model, vertex);
    const double n = double(s.parameters()), square = n * n;
    const uint64_t texels = s.maps * s.surface_texels + s.view_texels;
    const double rows = double(s.samples + texels * (s.terms + 1));
    const uint64_t look_up = 4 * s.terms;  // of the view map, per sample
    const uint64_t view_penalties = penalty_doubles(s.view, s.terms);
    const uint64_t sparse =
        s.samples * (s.terms + look_up) + s.maps * penalty_doubles(s.tile, s.terms) + view_penalties;
    double doubles = 3 * double(sparse);                          // with indices, and copies by block
    if (memory == CeresMemory::dense_qr) doubles = 3 * rows * n;  // J, by rows and by columns, and its factor
    if (memory == CeresMemory::dense_normal) doubles = rows * n + 2 * square;
    if (memory == CeresMemory::dense_schur) doubles += 2 * square;  // how many texels are eliminated is Ceres' choice
    if (memory == CeresMemory::sparse_factor) doubles += square;
    if (memory == CeresMemory::dense_maps)
        doubles = double(s.samples * (s.surface + look_up) + s.maps * s.surface_texels * (s.terms + 1) * s.surface +
                         view_penalties + 2 * s.view_map * s.view_map + 2 * s.maps * s.surface * s.surface);
    if (memory == CeresMemory::vectors) doubles = 50 * n;  // L-BFGS keeps 20 pairs of vectors
    constexpr double of_a_block = 800;                     // of residuals, in Ceres' structures
    const double bytes = doubles * sizeof(double) + double(s.samples + texels) * of_a_block;
    return uint64_t(std::min(bytes, 1e15));  // times any number of threads it stays within 64 bits
}

uint64_t pca_bytes(const LfmOptions& model, const VertexShape& vertex) {
    const Sizes s(model, vertex);
    const uint64_t rows = s.maps * s.surface_texels, columns = s.view_texels, least = std::min(rows, columns);
    // Three channels, a byte for whether an entry is invented, and of one channel the Gram matrix with its
    // eigenvectors.
    return (3 * sizeof(double) + 1) * rows * columns + sizeof(double) * 5 * least * least;
}

}  // namespace radiafit::fits
