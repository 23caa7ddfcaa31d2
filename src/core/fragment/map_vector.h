#pragma once
#include <span>
#include <vector>

#include "fragment/fragment_options.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "model/lfm.h"

namespace radiafit {

inline GLenum storage_format(Storage storage) {
    return storage == Storage::fp32 ? GL_RGBA32F : storage == Storage::fp16 ? GL_RG32UI : GL_RGBA16F;
}
inline GLenum sums_format(Sums sums) { return sums == Sums::fp32 ? GL_RGBA32F : GL_RGBA16F; }

/// Where problems are in M-texel textures, and their view maps in N-texel ones: vertex v at (v % columns, v /
/// columns), times the view map's side.
struct ProblemGrid {
    int columns = 1, rows = 1, view_side = 8;
    ProblemGrid(size_t vertices, int view_side);
    std::array<int, 2> at(size_t v) const { return {int(v) % columns, int(v) / columns}; }
};

/// Definitions for shaders of a loss (shaders/model/loss.glsl) and weights; empty: squares of equal weight.
Defines loss_defines(const Loss& loss);

/// Everything that fixes the shape of an N-texel array.
struct MapShape {
    const TriangleAtlas* atlas;
    const VertexRings* rings;
    const LfmLayout* layout;
    ProblemGrid grid;
    Loss loss;
    int terms() const { return layout->terms(); }
    int surface_layers() const { return 3 * terms(); }
    /// TERMS, VIEW_SIDE, COLUMNS, SIDE, RECTANGLES, STORAGE, and of loss_defines()
    Defines defines(Storage storage) const;
};

/// An N-texel array in the layout of the paper: surface maps [corner][term] in the atlas's 2-D layout, view maps [term]
/// tiled by vertex.
class MapVector {
public:
    MapVector(const MapShape& shape, Storage storage);  ///< shape must outlive it
    void upload(std::span<const float> values);         ///< Parameters order
    void download(std::span<float> values) const;       ///< Parameters order; waits
    void clear() {
        surface_.clear();
        view_.clear();
    }
    const Texture& surface() const { return surface_; }
    const Texture& view() const { return view_; }
    Target surface_target(int corner, int term) const { return {&surface_, corner * shape_->terms() + term}; }
    Target view_target(int term) const { return {&view_, term}; }

private:
    Texture surface_, view_;
    const MapShape* shape_;
    Storage storage_;
};

}  // namespace radiafit
