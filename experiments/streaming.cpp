// Section 6.5: what it costs where the images of every sweep come from: a cold disk, the page cache, host memory, or
// textures that stay on the device.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "app/limits.h"
#include "base/error.h"
#include "base/file.h"
#include "base/log.h"
#include "base/statistics.h"
#include "dataset/dataset_json.h"
#include "experiment.h"
#include "model/lfm_start.h"
#include "reflectance_problem.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

constexpr const char* sources[] = {"disk-cold", "disk", "memory", "device"};
constexpr int cold = 0, warm = 1, source_count = 4;

struct Options {
    std::string dataset = "star";
    int repetitions = 5;
    FitRequest request;
    ReflectanceProblem reflectance;

    explicit Options(Config& c) : reflectance(c) {
        request.set("mode", "paper");
        request.set("view", "nearest");
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, request.model);
        c.read("repetitions", repetitions, limits::repetitions);
        c.finish();
    }
};

/// Seconds of one iteration's halves; streaming: reading images and handing them to OpenGL, which the total includes.
struct Iteration {
    double line = 0, direction = 0, line_streaming = 0, direction_streaming = 0;
    double total(bool descent) const { return direction + (descent ? 0 : line); }
    double streaming(bool descent) const { return direction_streaming + (descent ? 0 : line_streaming); }
};

/// One problem with one kind of passes.
struct Contest {
    std::string problem, passes;
    std::vector<Iteration> times[source_count] = {};  ///< [source][repetition]
    double cached_share = 0;  ///< of the images' pages, the most before or after any iteration from a cold disk
    double warm_share = 1;    ///< the least before any iteration from the page cache
};

const ConjugateGradients schedule({.rule = Rule::cg_paper});

/// An iteration as optim/optimizer.h calls it. Steepest descent takes the same but for the line, which it has in its
/// first iteration only.
template <Engine E>
Iteration iterate(E& engine) {
    Iteration took;
    const auto time_half = [&](double& seconds, double& streaming, const auto& half) {
        const FragmentTimes before = engine.times();
        Stopwatch clock;
        half();
        engine.summary();  // waits
        seconds = clock.wall_s();
        streaming = engine.times().stream_s - before.stream_s + engine.times().upload_s - before.upload_s;
    };
    time_half(took.line, took.line_streaming, [&] { schedule.move(engine, 1); });
    time_half(took.direction, took.direction_streaming, [&] { schedule.judge(engine, 1); });
    return took;
}

/// Into the page cache.
void read_whole(const std::filesystem::path& path) {
    const InputFile file(path);
    std::vector<char> bytes(1 << 20);
    for (uint64_t at = 0; at < file.size(); at += bytes.size())
        file.read(bytes.data(), at, std::min<uint64_t>(bytes.size(), file.size() - at));
}

/// All sources by turns. make(options): an engine, started.
template <class Make>
Contest contest(const Dataset& dataset, const Options& o, const char* problem, const char* passes, const Make& make) {
    Contest c{.problem = problem, .passes = passes};
    std::vector<decltype(make(FragmentOptions()))> engines;
    std::vector<double> error;
    for (const char* source : sources) {
        FitRequest request = o.request;
        request.set("passes", passes);
        request.set("source", source);
        engines.push_back(make(request.fragment_options()));
        auto& engine = *engines.back();
        engine.make_room(schedule.room());
        schedule.judge(engine, 0);  // also compiles
        error.push_back(engine.summary().error);
        if (!(error.back() == error.front()))  // agree before you time
            throw SystemError(fmt::format("{} with images from {}: error {:.9g}, from {}: {:.9g}", problem, source,
                                          error.back(), sources[0], error.front()));
    }
    const std::filesystem::path images = dataset.folder / dataset_images_name;
    for (int repetition = 0; repetition < o.repetitions; ++repetition)
        for (int i = 0; i < source_count; ++i) {
            // Whoever came before left the page cache as it liked.
            if (i == cold) drop_from_cache(images);
            if (i == warm) read_whole(images);
            const double before = cached_share(images);
            if (i == warm) c.warm_share = std::min(c.warm_share, before);
            c.times[i].push_back(iterate(*engines[size_t(i)]));
            if (i == cold) c.cached_share = std::max({c.cached_share, before, cached_share(images)});
        }
    return c;
}

void write_rows(const ResultFolder& results, const std::vector<Contest>& contests, const std::string& renderer) {
    CsvWriter each(results.path() / "iterations.csv", {"problem", "passes", "source", "repetition", "line_s",
                                                       "line_streaming_s", "direction_s", "direction_streaming_s"});
    CsvWriter rows(
        results.path() / "times.csv",
        {"problem", "passes", "optimizer", "source", "seconds_per_iteration", "streaming_s", "streaming_share",
         "over_disk_cold", "faster_repetitions", "repetitions", "cached_share", "warm_share", "renderer"});
    Table table({"problem", "passes", "source", "time per iteration", "streaming", "over a cold disk"});
    for (const Contest& c : contests) {
        for (int i = 0; i < source_count; ++i)
            for (size_t r = 0; r < c.times[i].size(); ++r) {
                const Iteration& t = c.times[i][r];
                std::vector<std::string> row{c.problem, c.passes, sources[i], std::to_string(r)};
                for (double x : {t.line, t.line_streaming, t.direction, t.direction_streaming})
                    row.push_back(fmt::format("{:.5g}", x));
                each.row(row);
            }
        for (const bool descent : {true, false})
            for (int i = 0; i < source_count; ++i) {
                std::vector<double> seconds, streaming, shares, ratios;
                for (size_t r = 0; r < c.times[i].size(); ++r) {
                    const Iteration &t = c.times[i][r], &cold = c.times[0][r];
                    seconds.push_back(t.total(descent));
                    streaming.push_back(t.streaming(descent));
                    shares.push_back(streaming.back() / seconds.back());
                    ratios.push_back(seconds.back() / cold.total(descent));
                }
                const auto faster = std::count_if(ratios.begin(), ratios.end(), [](double x) { return x < 1; });
                const auto number = [](double x) { return fmt::format("{:.5g}", x); };
                rows.row({c.problem, c.passes, descent ? "sd" : "cg", sources[i], number(median(seconds)),
                          number(median(streaming)), number(median(shares)), number(median(ratios)),
                          std::to_string(faster), std::to_string(ratios.size()), number(c.cached_share),
                          number(c.warm_share), renderer});
                table.add({fmt::format("{}, {}", c.problem, descent ? "sd" : "cg"), c.passes, sources[i],
                           fmt::format("{:.3f} s", median(seconds)), fmt::format("{:.1f} %", 100 * median(shares)),
                           fmt::format("{:.3f}", median(ratios))});
            }
    }
    each.commit();
    rows.commit();
    log_info("time of an iteration by where its images come from\n" + table.text());
}

void streaming(Experiment& experiment) {
    Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    o.reflectance.open(experiment);
    const auto context = Context::create(o.request.context);
    note_gl(*context, experiment.record());
    const TriangleAtlas atlas(dataset.mesh, o.request.model.surface_side);
    const VertexRings rings(dataset.mesh);
    std::vector<Contest> contests;
    for (const char* passes : {"paper", "combined"})
        contests.push_back(contest(dataset, o, "light field map", passes, [&](const FragmentOptions& options) {
            auto engine = std::make_unique<FragmentEngine>(dataset, atlas, rings, dataset.split(false),
                                                           o.request.model_options(), options);
            engine->reset(lfm_start(engine->layout(), engine->count().mean, o.request.seed));
            return engine;
        }));
    for (const char* passes : {"paper", "combined"})
        contests.push_back(
            contest(o.reflectance.dataset(), o, "Lafortune", passes, [&](const FragmentOptions& options) {
                auto engine = o.reflectance.engine(options);
                engine->reset(engine->start());
                return engine;
            }));
    ResultFolder results = experiment.open_results(context->renderer());
    write_rows(results, contests, context->renderer());
    results.commit();
    experiment.draw(results, fmt::format("{} and {} images of {} ({} scale), medians of {} iterations; {}",
                                         dataset.name, o.reflectance.images(), o.reflectance.dataset().name,
                                         experiment.profile(), o.repetitions, context->renderer()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("streaming", argc, argv, radiafit::streaming); }
