#include <algorithm>

#include "compute/sample_store.h"
#include "compute/scatter_sums.h"

namespace radiafit {
namespace {

/// An invocation is a sample.
class CachedScatter final : public SampleSweeps {
public:
    CachedScatter(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                  const VertexRings& rings, const SampleList& samples, Accumulate accumulate);
    Defines sums() const override { return sums_.reading_defines(); }
    void bind_to(const Program& program) const override { sums_.bind_to(program); }
    TileStatistics count() override;
    void gradient_pass(bool diagonal) override;
    void directional_pass() override;

private:
    Program look_up(int maps, const FetchedBuffer& into) const;
    Program scatter(int maps, const Defines& more) const;
    size_t groups() const { return r_.problems.groups(samples_.sample_count()); }

    SweepResources r_;
    SampleStore samples_;
    ScatterSums sums_;
    FetchedBuffer pair_values_, pair_slopes_;
    float target_scale_;
    Program look_up_trial_, look_up_p_, look_up_along_, gradient_[2], line_;
};

CachedScatter::CachedScatter(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                             const VertexRings& rings, const SampleList& samples, Accumulate accumulate)
    : r_(resources),
      samples_(dataset, atlas, rings, samples, r_.options, SampleStore::Order::listed, uint32_t(r_.problems.lanes()),
               r_.tables),
      sums_(r_, accumulate, samples_.pair_count(), samples.scale),
      target_scale_(samples.scale) {
    for (FetchedBuffer* of_pairs : {&pair_values_, &pair_slopes_})
        *of_pairs =
            FetchedBuffer::written("cameras' views of vertices", samples_.pair_count() * size_t(r_.options.terms));
    look_up_trial_ = look_up(vector::trial, pair_values_);
    look_up_p_ = look_up(vector::p, pair_values_);
    look_up_along_ = look_up(vector::d, pair_slopes_);
    gradient_[0] = scatter(vector::trial, sums_.defines());
    gradient_[1] = scatter(vector::trial, sums_.defines() + Defines{{"DIAGONAL", ""}});
    line_ = scatter(vector::p, sums_.defines() + line_defines(r_.options));
}

Program CachedScatter::look_up(int maps, const FetchedBuffer& into) const {
    Program made = r_.program_over(maps, "look_up_pair.comp");
    samples_.bind_to(made);
    made.bind("PairValues", into.buffer);
    return made;
}

Program CachedScatter::scatter(int maps, const Defines& more) const {
    Program made = r_.program("scatter_samples.comp", samples_.defines() + more);
    samples_.bind_to(made);
    sums_.bind_to(made);
    made.bind_if_used("maps", r_.vectors[size_t(maps)].texture);
    made.bind_if_used("direction", r_.vectors[vector::d].texture);
    made.bind_if_used("pair_values", pair_values_.texture);
    made.bind_if_used("pair_slopes", pair_slopes_.texture);
    return made;
}

TileStatistics CachedScatter::count() {
    const SampleCounter counter(r_.tables, target_scale_, 1.0 + std::ranges::max(samples_.tile_samples()));
    Program counting = scatter(vector::trial, SampleCounter::defines());
    counter.bind_to(counting);
    counting.dispatch(groups());
    return counter.read();
}

void CachedScatter::gradient_pass(bool diagonal) {
    sums_.begin_gradient(diagonal);
    look_up_trial_.dispatch(r_.problems.groups(samples_.pair_count()));
    gradient_[diagonal].dispatch(groups());
    sums_.spread(samples_.pairs(), diagonal);
}

void CachedScatter::directional_pass() {
    sums_.begin_line();
    look_up_p_.dispatch(r_.problems.groups(samples_.pair_count()));
    look_up_along_.dispatch(r_.problems.groups(samples_.pair_count()));
    line_.dispatch(groups());
}

}  // namespace

std::unique_ptr<SampleSweeps> make_cached_scatter(const SweepResources& resources, const Dataset& dataset,
                                                  const TriangleAtlas& atlas, const VertexRings& rings,
                                                  const SampleList& samples, Accumulate accumulate) {
    return std::make_unique<CachedScatter>(resources, dataset, atlas, rings, samples, accumulate);
}

}  // namespace radiafit
