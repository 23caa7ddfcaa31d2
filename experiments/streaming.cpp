// Section 6.5: what it costs where the images of every sweep come from: a cold disk, the page cache, host memory, or
// textures that stay on the device.
#include "rows/streaming.h"

#include <fmt/format.h>

#include <memory>

#include "base/error.h"
#include "base/log.h"
#include "base/statistics.h"
#include "base/time_limit.h"
#include "bench/bundle.h"
#include "dataset/dataset_json.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "iteration_time.h"
#include "model/lfm_start.h"
#include "reflectance_problem.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::streaming;

constexpr ImageSource sources[] = {ImageSource::disk_cold, ImageSource::disk, ImageSource::memory, ImageSource::device};
constexpr const char* source_names[] = {"disk-cold", "disk", "memory", "device"};
constexpr int cold = 0, source_count = 4;

struct Options {
    std::string dataset = "star";
    int images = 32, repetitions = 9;
    FitRequest request;
    ReflectanceProblem reflectance;

    explicit Options(Config& c) : reflectance(c) {
        request.set("mode", "paper");
        request.set("view", "nearest");
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, request.model);
        c.read("images", images, limits::images);
        c.read("repetitions", repetitions, limits::repetitions);
        c.finish();
    }
};

/// One problem with one kind of passes.
struct Contest {
    std::string problem, passes;
    std::vector<IterationTime> times[source_count] = {};  ///< [source][repetition]
};

/// All sources by turns. make(options): an engine and its start.
template <class Make>
Contest contest(const Dataset& dataset, const Options& o, const char* problem, const char* passes, const Make& make) {
    Contest c{.problem = problem, .passes = passes};
    std::vector<decltype(make(FragmentOptions()).first)> engines;
    std::vector<double> error;
    for (const char* source : source_names) {
        FitRequest request = o.request;
        request.set("passes", passes);
        request.set("source", source);
        auto [engine, start] = make(request.fragment_options());
        start_iterations(*engine, start);
        error.push_back(engine->summary().error);
        if (!(error.back() == error.front()))  // agree before you time
            throw SystemError(fmt::format("{} with images from {}: error {:.9g}, from {}: {:.9g}", problem, source,
                                          error.back(), source_names[0], error.front()));
        engines.push_back(std::move(engine));
    }
    const std::filesystem::path images = dataset.folder / dataset_images_name;
    for (int repetition = 0; another_round(repetition, o.repetitions); ++repetition)
        for (int i = 0; i < source_count; ++i)
            c.times[i].push_back(time_iteration(*engines[size_t(i)], images, sources[i]));
    log_info(fmt::format("{}, {} passes: {} iterations from each source", problem, passes, o.repetitions));
    return c;
}

void write_iterations(const ResultFolder& results, const std::vector<Contest>& contests) {
    CsvFile rows(results.path(), rows::iterations);
    for (const Contest& c : contests)
        for (int i = 0; i < source_count; ++i)
            for (size_t r = 0; r < c.times[i].size(); ++r) {
                const auto& [line, direction, cached_share] = c.times[i][r];
                rows.add({c.problem, c.passes, source_names[i], r, line.seconds, line.streaming, direction.seconds,
                          direction.streaming, cached_share});
            }
    rows.commit();
}

/// Medians of the same, with the 95 % interval of the time where there are enough repetitions for one.
void write_times(const ResultFolder& results, const std::vector<Contest>& contests, const std::string& renderer) {
    CsvFile rows(results.path(), rows::times);
    Table table({"problem", "passes", "source", "time per iteration", "streaming", "over a cold disk"});
    for (const Contest& c : contests)
        for (const std::string optimizer : optimizer_names)
            for (int i = 0; i < source_count; ++i) {
                std::vector<double> seconds, streaming, shares, ratios;
                for (size_t r = 0; r < c.times[i].size(); ++r) {
                    const HalfTime time = c.times[i][r].of(is_descent(optimizer));
                    seconds.push_back(time.seconds);
                    streaming.push_back(time.streaming);
                    shares.push_back(time.streaming / time.seconds);
                    ratios.push_back(time.seconds / c.times[cold][r].of(is_descent(optimizer)).seconds);
                }
                const auto [low, high] = ends_of(median_interval(seconds, seconds.size()));
                rows.add({c.problem, c.passes, optimizer, source_names[i], median(seconds), low, high,
                          median(streaming), median(shares), median(ratios), seconds.size(), renderer});
                table.add({fmt::format("{}, {}", c.problem, optimizer), c.passes, source_names[i],
                           fmt::format("{:.3f} s", median(seconds)), fmt::format("{:.1f} %", 100 * median(shares)),
                           fmt::format("{:.3f}", median(ratios))});
            }
    rows.commit();
    log_info("time of an iteration by where its images come from\n" + table.text());
}

void measure(Experiment& experiment) {
    Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    o.reflectance.open(experiment);
    const auto context = Context::create(o.request.context);
    note_gl(*context, experiment.record());
    const TriangleAtlas atlas(dataset.mesh, o.request.model.surface_side);
    const VertexRings rings(dataset.mesh);
    const std::vector<uint32_t> views = spread_views(dataset.split(false), o.images);
    share_time(4);  // two problems, two kinds of passes
    std::vector<Contest> contests;
    for (const char* passes : {"paper", "combined"})
        contests.push_back(contest(dataset, o, "light field map", passes, [&](const FragmentOptions& options) {
            auto engine =
                std::make_unique<FragmentEngine>(dataset, atlas, rings, views, o.request.model_options(), options);
            std::vector<float> start = lfm_start(engine->layout(), engine->count().mean, o.request.seed);
            return std::pair(std::move(engine), std::move(start));
        }));
    for (const char* passes : {"paper", "combined"})
        contests.push_back(
            contest(o.reflectance.dataset(), o, "Lafortune", passes, [&](const FragmentOptions& options) {
                auto engine = o.reflectance.engine(options);
                std::vector<float> start = engine->start();
                return std::pair(std::move(engine), std::move(start));
            }));
    ResultFolder results = experiment.open_results(context->renderer());
    write_iterations(results, contests);
    write_times(results, contests, context->renderer());
    experiment.finish(results,
                      fmt::format("{} images of the {} stand-in, {} of the {} ({} scale), {} repetitions; {} on {}",
                                  views.size(), dataset.name, o.reflectance.images(), o.reflectance.dataset().name,
                                  experiment.profile(), o.repetitions, context->renderer(), experiment.cpu_device()));
}

}  // namespace

int streaming(int argc, const char* const* argv) { return run_experiment("streaming", argc, argv, measure); }

}  // namespace radiafit::harness
