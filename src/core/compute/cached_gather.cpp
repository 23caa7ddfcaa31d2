#include "compute/sample_store.h"
#include "compute/sample_sweeps.h"

namespace radiafit {
namespace {

/// A work group is a tile; every sum has one invocation, and work groups add up in a fixed order.
class CachedGather final : public SampleSweeps {
public:
    CachedGather(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                 const VertexRings& rings, const SampleList& samples);
    Defines sums() const override { return {{"SUMS", "sums_by_pair"}}; }
    void bind_to(const Program& program) const override;
    TileStatistics count() override;
    void gradient_pass(bool diagonal) override;
    void directional_pass() override;

private:
    Program program(int maps, const std::string& file, const Defines& more = {}) const;
    void look_up(int maps);
    void sum_over_pairs(const FetchedBuffer& into);

    SweepResources r_;
    SampleStore samples_;
    FetchedBuffer pair_values_, pair_slopes_;  ///< what cameras see of view maps, of x and along d
    FetchedBuffer group_sums_, pair_sums_, pair_squares_, tile_sums_;
    Program count_, look_up_, look_up_along_, group_pass_, square_pass_, pair_pass_, texel_passes_[2], line_;
};

CachedGather::CachedGather(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                           const VertexRings& rings, const SampleList& samples)
    : r_(resources),
      samples_(dataset, atlas, rings, samples, r_.options, SampleStore::Order::gathered, uint32_t(r_.problems.lanes()),
               r_.tables) {
    const auto terms = size_t(r_.options.terms);
    for (FetchedBuffer* of_pairs : {&pair_values_, &pair_slopes_, &pair_sums_, &pair_squares_})
        *of_pairs = FetchedBuffer::written("cameras' views of vertices", samples_.pair_count() * terms);
    group_sums_ = FetchedBuffer::written("sums of groups of samples", samples_.group_count() * 3 * terms);
    tile_sums_ = FetchedBuffer::written("sums of triangles", r_.tables.tile_count() * 3 * tile_sums);
    count_ = program(vector::trial, "count.comp");
    look_up_ = program(vector::trial, "look_up.comp");
    look_up_.bind("PairValues", pair_values_.buffer);
    look_up_along_ = program(vector::d, "look_up.comp");
    look_up_along_.bind("PairValues", pair_slopes_.buffer);
    group_pass_ = program(vector::trial, "tile_groups.comp");
    square_pass_ = program(vector::trial, "tile_groups.comp", {{"SQUARES", ""}});
    pair_pass_ = program(vector::trial, "pair_sums.comp");
    for (const bool diagonal : {false, true}) {
        texel_passes_[diagonal] =
            program(vector::trial, "tile_texels.comp", diagonal ? Defines{{"DIAGONAL", ""}} : Defines{});
        texel_passes_[diagonal].bind("Gradient", r_.vectors[vector::trial_g].buffer);
        texel_passes_[diagonal].bind_if_used("Fresh", r_.vectors[vector::fresh].buffer);
    }
    line_ = program(vector::p, "tile_line.comp");
    line_.bind("direction", r_.vectors[vector::d].texture);
    line_.bind("pair_slopes", pair_slopes_.texture);
}

Program CachedGather::program(int maps, const std::string& file, const Defines& more) const {
    Program made = r_.program(file, samples_.defines() + more);
    made.bind_if_used("maps", r_.vectors[size_t(maps)].texture);
    samples_.bind_to(made);
    made.bind_if_used("pair_values", pair_values_.texture);
    made.bind_if_used("group_sums", group_sums_.texture);
    made.bind_if_used("GroupSums", group_sums_.buffer);
    made.bind_if_used("TileSums", tile_sums_.buffer);
    return made;
}

void CachedGather::bind_to(const Program& program) const {
    samples_.bind_to(program);
    program.bind_if_used("pair_sums", pair_sums_.texture);
    program.bind_if_used("pair_squares", pair_squares_.texture);
    program.bind_if_used("tile_sums", tile_sums_.texture);
}

TileStatistics CachedGather::count() {
    count_.dispatch(r_.tables.tile_count());
    std::vector<float> sums(r_.tables.tile_count() * 3 * tile_sums * 4);
    tile_sums_.buffer.read(0, sums.size() * sizeof(float), sums.data());
    TileStatistics all{samples_.tile_samples(), {}};
    for (size_t corner = 0; corner < 3 * r_.tables.tile_count(); ++corner)
        for (size_t c = 0; c < 3; ++c) all.targets.push_back(sums[corner * tile_sums * 4 + c]);
    return all;
}

void CachedGather::look_up(int maps) {
    look_up_.bind("maps", r_.vectors[size_t(maps)].texture);
    look_up_.dispatch(r_.layout.problem_count());
}

void CachedGather::sum_over_pairs(const FetchedBuffer& into) {
    pair_pass_.bind("PairSums", into.buffer);
    pair_pass_.dispatch(r_.layout.problem_count());
}

void CachedGather::gradient_pass(bool diagonal) {
    const size_t tiles = r_.tables.tile_count();
    look_up(vector::trial);
    group_pass_.dispatch(tiles);
    sum_over_pairs(pair_sums_);
    if (diagonal) {
        square_pass_.dispatch(tiles);
        sum_over_pairs(pair_squares_);
    }
    texel_passes_[diagonal].dispatch(tiles);
}

void CachedGather::directional_pass() {
    look_up(vector::p);
    look_up_along_.dispatch(r_.layout.problem_count());
    line_.dispatch(r_.tables.tile_count());
}

}  // namespace

std::unique_ptr<SampleSweeps> make_cached_gather(const SweepResources& resources, const Dataset& dataset,
                                                 const TriangleAtlas& atlas, const VertexRings& rings,
                                                 const SampleList& samples) {
    return std::make_unique<CachedGather>(resources, dataset, atlas, rings, samples);
}

}  // namespace radiafit
