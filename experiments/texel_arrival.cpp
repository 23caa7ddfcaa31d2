#include "texel_arrival.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/instructions.h"
#include "base/log.h"
#include "base/scoped_threads.h"
#include "base/statistics.h"
#include "samples/picked_texels.h"

namespace radiafit::harness {
namespace {

using rows_of::reflectance::Arrival;

/// Those of one block out of so many.
std::vector<uint32_t> some_blocks(uint32_t texels, int every) {
    std::vector<uint32_t> some;
    for (uint32_t t = 0; t < texels; ++t)
        if (t / TexelSource::block % uint32_t(every) == 0) some.push_back(t);
    return some;
}

/// One rung of a climber.
struct Rung {
    const Climber* climber;
    int iterations;
    std::vector<double> seconds = {};  ///< of each repetition
    std::vector<float> error = {};     ///< of every texel
};

}  // namespace

std::vector<Arrival> texel_arrivals(const Dataset& dataset, const SharedTexels& samples,
                                    const std::vector<Climber>& climbers, const ArrivalOptions& options) {
    const ScopedThreads one(1);
    SharedTexels some;
    some.texels = some_blocks(samples.source->texel_count(), options.every);
    some.source = std::make_unique<PickedTexels>(*samples.source, some.texels);
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

    std::vector<uint32_t> fitted;
    for (uint32_t t = 0; t < counts.size(); ++t)
        if (counts[t] >= options.least_samples) fitted.push_back(t);
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
