#include "texel_arrival.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/instructions.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"

namespace radiafit::harness {
namespace {

using rows_of::reflectance::Arrival;

/// The samples of one block out of so many; other texels have none.
class SomeBlocks final : public TexelSource {
public:
    SomeBlocks(const TexelSource& source, int every) : source_(&source), every_(uint32_t(every)) {
        TexelSamples samples;
        for (uint32_t begin = 0; begin < texel_count(); begin += block) {
            read(begin, samples);
            count_ += samples.samples.size();
        }
    }
    uint32_t texel_count() const override { return source_->texel_count(); }
    uint64_t sample_count() const override { return count_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        if (begin / block % every_ == 0) return source_->read(begin, out);
        out.first.assign(std::min(block, texel_count() - begin) + 1, 0);
        out.samples.clear();
    }

private:
    const TexelSource* source_;
    uint32_t every_;
    uint64_t count_ = 0;
};

/// One rung of a climber.
struct Rung {
    const Climber* climber;
    int iterations;
    std::vector<double> seconds = {};  ///< of each repetition
    std::vector<float> error = {};     ///< of every texel
};

class SetThreads {
public:
    explicit SetThreads(int count) : before_(thread_count()) { set_thread_count(count); }
    ~SetThreads() { set_thread_count(before_); }
    SetThreads(const SetThreads&) = delete;
    SetThreads& operator=(const SetThreads&) = delete;

private:
    int before_;
};

}  // namespace

std::vector<Arrival> texel_arrivals(const Dataset& dataset, const SharedTexels& samples,
                                    const std::vector<Climber>& climbers, const ArrivalOptions& options) {
    const SetThreads one(1);
    SharedTexels some;
    some.source = std::make_unique<SomeBlocks>(*samples.source, options.every);
    std::vector<Rung> rungs;
    for (const Climber& climber : climbers)
        for (const int iterations : climber.iterations) rungs.push_back({&climber, iterations});
    std::vector<uint32_t> counts;
    Progress progress("fits on one thread", rungs.size() * size_t(options.repetitions));
    for (int repetition = 0; repetition < options.repetitions; ++repetition)
        for (Rung& rung : rungs) {
            std::optional<BaseInstructions> base;
            if (rung.climber->base_instructions) base.emplace();
            FitRequest request = rung.climber->request;
            request.iterations = rung.iterations;
            ReflectanceOutcome out = solve_reflectance(dataset, request, {}, nullptr, &some);
            rung.seconds.push_back(out.times.optimization);
            rung.error = std::move(out.fit.error);
            counts = std::move(out.fit.samples);
            progress.advance();
        }
    progress.finish();

    std::vector<uint32_t> fitted;  // texels that have more samples than a fit has unknowns
    for (uint32_t t = 0; t < counts.size(); ++t)
        if (counts[t] >= 9) fitted.push_back(t);
    std::vector<float> least(counts.size(), INFINITY);
    for (const Rung& rung : rungs)
        for (const uint32_t t : fitted) least[t] = std::fmin(least[t], rung.error[t]);
    std::vector<Arrival> rows;
    for (const Rung& rung : rungs) {
        const auto arrived = std::ranges::count_if(
            fitted, [&](uint32_t t) { return double(rung.error[t]) <= options.tolerance * double(least[t]); });
        const Engineering& how = rung.climber->how;
        rows.push_back({rung.climber->name, rung.iterations, fitted.size(),
                        double(arrived) / double(std::max<size_t>(1, fitted.size())), median(rung.seconds),
                        std::ranges::min(rung.seconds), std::ranges::max(rung.seconds), rung.seconds.size(),
                        how.precision, how.together, how.instructions});
    }
    return rows;
}

}  // namespace radiafit::harness
