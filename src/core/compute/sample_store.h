#pragma once
#include <array>

#include "compute/map_tables.h"
#include "dataset/dataset.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

namespace radiafit {

/// The samples of a light field map on the device, and what leads to them: what shaders/compute/samples.glsl and
/// listed_samples.glsl read. A sample counts for the problems of its triangle's three vertices.
///
/// Of the two orders, `gathered` has each sample twice, by what a tile takes of an image (a group) and by texel, so
/// that every sum over samples has one invocation that makes it, in one order. Groups of a tile, and its texels, are
/// taken in blocks of as many as a work group has invocations, those with most samples first; the samples of a block
/// lie row by row, so that neighbours read neighbours. A sample takes four bytes in either order, or all take eight:
/// where colours have more than 8 bits, or some tile more than 256 texels or groups.
///
/// `listed` has each sample once, as the list has them, with its group: four bytes (or eight) and four.
class SampleStore {
public:
    enum class Order { gathered, listed };

    /// Nothing of the arguments is kept but tables, whose words about samples it fills and which it uploads, and which
    /// must outlive it. lanes: invocations of a work group. Throws UserError where a buffer would be larger than the
    /// device allows.
    SampleStore(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const SampleList& samples,
                const LfmOptions& options, Order order, uint32_t lanes, MapTables& tables);

    Defines defines() const { return wide_ ? Defines{{"WIDE", ""}} : Defines{}; }
    /// Binds and sets all buffers and uniforms of these that a program uses.
    void bind_to(const Program& program) const;
    /// Cameras' views of vertices: one for each vertex and each image in which some texel of its ring takes a pixel.
    size_t pair_count() const { return pair_count_; }
    const Texture& pairs() const { return pairs_.texture; }
    size_t group_count() const { return group_count_; }
    size_t sample_count() const { return sample_count_; }
    const std::vector<uint32_t>& tile_samples() const { return tile_samples_; }  ///< [tiles]

private:
    /// [group]: samples, or `listed`, the tile; pairs of the tile's three vertices with the image.
    using Groups = std::vector<std::array<uint32_t, 4>>;
    void check(const TriangleAtlas& atlas, const SampleList& samples, Order order);
    void place_by_group_and_texel(const SampleList& samples, uint32_t lanes, MapTables& tables, Groups& groups,
                                  std::vector<uint32_t>& image_of_group);
    void list(const SampleList& samples, Groups& groups, std::vector<uint32_t>& image_of_group);
    void add_pairs(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                   const SampleList& samples, const LfmOptions& options, Order order,
                   const std::vector<uint32_t>& image_of_group, MapTables& tables, Groups& groups);

    size_t pair_count_ = 0, group_count_, sample_count_;
    std::vector<uint32_t> tile_samples_;
    bool wide_ = false;
    FetchedBuffer pairs_, groups_, by_group_, by_texel_, listed_, listed_groups_;
};

}  // namespace radiafit
