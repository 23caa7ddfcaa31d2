#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "base/clock.h"
#include "base/error.h"
#include "base/file.h"
#include "fitting/fit_request.h"
#include "fragment/fragment_engine.h"
#include "gl/context.h"
#include "optim/optimizer.h"

/// Iterations of engines in the paper's mode, timed whole or half by half, for the experiments about where the time
/// goes.
namespace radiafit::harness {

/// Seconds of one half: a sweep over the images, then passes over maps.
struct HalfTime {
    double seconds = 0;    ///< all of it
    double sweep = 0;      ///< until the last image is done
    double streaming = 0;  ///< of the sweep: reading images and handing them to OpenGL
    /// From the sweep's end to the finished gradient or line: penalties, their gather, and the gradient's last step.
    double penalties = 0;
    friend HalfTime operator+(const HalfTime& a, const HalfTime& b) {
        return {a.seconds + b.seconds, a.sweep + b.sweep, a.streaming + b.streaming, a.penalties + b.penalties};
    }
};

struct IterationTime {
    HalfTime line, direction;
    /// The share of the images' pages that were cached: before; from a cold disk before or after, whichever is more.
    double cached_share = 0;

    /// Steepest descent has its line in its first iteration only.
    HalfTime of(bool descent) const { return descent ? direction : line + direction; }
};

/// The optimizers in the rows.
constexpr const char* optimizer_names[] = {"sd", "cg"};
inline bool is_descent(const std::string& optimizer) { return optimizer == optimizer_names[0]; }

inline const ConjugateGradients paper_gradients({.rule = Rule::cg_paper}),
    paper_descent({.rule = Rule::steepest_descent});

/// The engine's verbs that those schedules call; passes that hold a sweep are timed to their end.
template <class E>
class PassClock {
public:
    explicit PassClock(E& engine) : engine_(engine) {}
    void gradient_pass(bool diagonal) {
        time([&] { engine_.gradient_pass(diagonal); });
    }
    void directional_pass() {
        time([&] { engine_.directional_pass(); });
    }
    void dot(std::initializer_list<DotProduct> products) { engine_.dot(products); }
    void step(Step which, const Turn& turn) { engine_.step(which, turn); }
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants) {
        engine_.update(which, vectors, numbers, constants);
    }
    double seconds() const { return seconds_; }

private:
    template <class Body>
    void time(const Body& body) {
        const Stopwatch clock;
        body();
        gl().Finish();
        seconds_ += clock.wall_s();
    }
    E& engine_;
    double seconds_ = 0;
};

/// Begins a fit; also compiles.
template <class E>
void start_iterations(E& engine, std::span<const float> start) {
    engine.reset(start);
    engine.make_room(paper_gradients.room());
    paper_gradients.judge(engine, 0);
    engine.summary();
}

/// Seconds of an iteration after the first: the mean of `iterations` of them.
template <class E>
double seconds_per_iteration(E& engine, int iterations) {
    const Stopwatch clock;
    for (int i = 0; i < iterations; ++i) {
        paper_gradients.move(engine, 1);
        paper_gradients.judge(engine, 1);
    }
    engine.summary();  // waits
    return clock.wall_s() / iterations;
}

/// What one iteration declares and issues, the same on any device.
struct IterationCounts {
    Work work = {};
    uint64_t draws = 0, switches = 0;
    std::map<std::string, PassTally> tallies = {};
};

/// Throws UserError for passes that declare no cost.
inline void require_costs(const std::map<std::string, PassTally>& tallies) {
    std::string missing;
    for (const auto& [label, tally] : tallies)
        if (!tally.cost) missing += (missing.empty() ? "" : "; ") + label;
    if (!missing.empty())
        throw UserError(
            fmt::format("no cost is declared in src/core/fragment/pass_costs.cpp of {}; choose a dataset with 8 bits a "
                        "channel, and storage fp32 or fp16",
                        missing));
}

/// Of what `body` issues. Waits for each draw, so not while others are timed.
template <class E, class Body>
IterationCounts count_passes(E& engine, const Body& body) {
    PassRunner& passes = engine.passes();
    const PassCounters before = passes.counters;
    passes.tally(true);
    body();
    passes.tally(false);
    IterationCounts counts{.draws = passes.counters.draws - before.draws,
                           .switches = passes.counters.framebuffer_switches - before.framebuffer_switches,
                           .tallies = passes.tallies()};
    require_costs(counts.tallies);
    for (const auto& [label, tally] : counts.tallies) counts.work += tally.work();
    return counts;
}

/// Of one iteration after the first.
template <class E>
IterationCounts count_iteration(E& engine, bool descent) {
    const ConjugateGradients& schedule = descent ? paper_descent : paper_gradients;
    return count_passes(engine, [&] {
        schedule.move(engine, 1);
        schedule.judge(engine, 1);
    });
}

/// Reads a file into the page cache.
inline void read_whole(const std::filesystem::path& path) {
    const InputFile file(path);
    std::vector<char> bytes(1 << 20);
    for (uint64_t at = 0; at < file.size(); at += bytes.size())
        file.read(bytes.data(), at, std::min<uint64_t>(bytes.size(), file.size() - at));
}

/// An iteration after the first, in the paper's mode; `images`: the file that the engine reads from `source`. The
/// page cache is as whatever ran before left it.
template <class E>
IterationTime time_iteration(E& engine, const std::filesystem::path& images, ImageSource source) {
    const auto half = [&](const auto& body) {
        const SweepTimes before = engine.times();
        PassClock<E> passes(engine);
        const Stopwatch clock;
        body(passes);
        engine.summary();  // waits
        const double seconds = clock.wall_s();
        const SweepTimes after = engine.times();
        const double sweep = after.sweep_s - before.sweep_s;
        return HalfTime{seconds, sweep, after.stream_s - before.stream_s + after.upload_s - before.upload_s,
                        passes.seconds() - sweep};
    };
    const bool cold = source == ImageSource::disk_cold;
    if (cold) drop_from_cache(images);
    if (source == ImageSource::disk) read_whole(images);
    IterationTime time;
    time.cached_share = cached_share(images);
    time.line = half([](auto& passes) { paper_gradients.move(passes, 1); });
    time.direction = half([](auto& passes) { paper_gradients.judge(passes, 1); });
    if (cold) time.cached_share = std::max(time.cached_share, cached_share(images));
    return time;
}

}  // namespace radiafit::harness
