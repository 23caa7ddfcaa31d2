#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/pack.h"
#include "model/texel_local.h"

namespace radiafit {

/// The samples of eight texels side by side: row i holds sample i of each, a lane per texel. Where a texel has fewer
/// samples than another, rows are padded with samples of no weight.
template <int terms>
class TexelBatch {
public:
    static constexpr int size = Pack::size;
    struct Row {
        Pack term[size_t(terms)], target[3], weight;
    };

    /// Empties all lanes; keeps storage.
    void clear() {
        rows_.clear();
        std::fill_n(lanes_, size, Lane{});
    }
    void reserve(size_t samples) { rows_.reserve(samples); }
    /// A sample without weight adds nothing and is left out.
    void push(int lane, const TexelSample<terms>& s) {
        Lane& to = lanes_[lane];
        float sum = s.weight + s.target[0] + s.target[1] + s.target[2];
        for (const float x : s.term) sum += x;
        to.finite = to.finite && std::isfinite(sum);
        if (s.weight == 0) return;
        if (to.count == rows_.size()) rows_.emplace_back();
        Row& row = rows_[to.count++];
        for (size_t k = 0; k < size_t(terms); ++k) row.term[k].set(lane, s.term[k]);
        for (size_t c = 0; c < 3; ++c) row.target[c].set(lane, s.target[c]);
        row.weight.set(lane, s.weight);
        for (const float x : s.target) to.squares += double(s.weight) * double(x) * double(x);
    }

    std::span<const Row> rows() const { return rows_; }
    /// Samples with a weight.
    uint32_t count(int lane) const { return lanes_[lane].count; }
    double squares(int lane) const { return lanes_[lane].squares; }  ///< sum w target^2
    /// Whether all that was pushed is finite.
    bool finite(int lane) const { return lanes_[lane].finite; }

private:
    struct Lane {
        uint32_t count = 0;
        double squares = 0;
        bool finite = true;
    };
    std::vector<Row> rows_;
    Lane lanes_[size_t(size)];
};

}  // namespace radiafit
