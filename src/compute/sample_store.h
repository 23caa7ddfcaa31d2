#pragma once
#include <array>

#include "compute/problem_buffers.h"
#include "dataset/dataset.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

namespace radiafit {

/// The samples of a light field map on the device, and the tables that lead to them: what shaders/compute/tables.glsl
/// and samples.glsl read. A sample counts for the problems of its triangle's three vertices. It stands there twice, by
/// what a tile takes of an image (a group) and by texel, so that every sum over samples has one invocation that makes
/// it, in one order. Groups of a tile, and its texels, are taken in blocks of as many as a work group has invocations,
/// those with most samples first; the samples of a block lie row by row, so that neighbours read neighbours. A sample
/// takes four bytes ineither order, or all take eight: where colours have more than 8 bits, or some tile more than 256
/// texels or groups.
class SampleStore {
public:
    /// Nothing of the arguments is kept. lanes: invocations of a work group. Throws UserError where a buffer would be
    /// larger than the device allows.
    SampleStore(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout,
                const SampleList& samples, const LfmOptions& options, uint32_t lanes);

    Defines defines() const { return wide_ ? Defines{{"WIDE", ""}} : Defines{}; }
    /// Tells a program of all buffers and uniforms that it uses of these.
    void bind_to(const Program& program) const;
    /// Cameras' views of vertices: one for each vertex and each image in which some texel of its ring takes a pixel.
    size_t pair_count() const { return pair_count_; }
    size_t group_count() const { return group_count_; }
    size_t tile_count() const { return size_t(tile_count_); }
    const std::vector<uint32_t>& tile_samples() const { return tile_samples_; }  ///< [tiles]

private:
    /// As shaders/compute/tables.glsl numbers them.
    enum Table {
        vertices,
        maps,
        sites,
        neighbours,
        cell_first,
        cell_pairs,
        pair_first,
        pair_groups,
        tiles,
        blocks,
        texels,
        table_count
    };

    size_t pair_count_ = 0, group_count_ = 0;
    std::vector<uint32_t> tile_samples_;
    bool wide_ = false;
    int vertex_count_, tile_count_, view_neighbours_ = 0;
    std::array<int, table_count> table_begin_{};
    FetchedBuffer tables_, pairs_, groups_, target_weights_, by_group_, by_texel_;
};

}  // namespace radiafit
