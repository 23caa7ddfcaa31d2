// Memory and time against the size of the problem: bytes of the fragment engine over parameters, planned and allocated,
// beside Section 6.3's accounting; seconds of an iteration over radiance samples (claims C14 and C18).
#include <fmt/format.h>

#include <algorithm>

#include "app/limits.h"
#include "base/error.h"
#include "base/log.h"
#include "experiment.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

constexpr Range<int> image_counts{1, limits::images.upper};

struct Options {
    std::string dataset = "star";
    std::vector<int> sides = {16, 20, 24, 32}, images = {22, 44, 87};
    int time_side = 8, iterations = 3, rounds = 3, repeat_cpu = 1, repeat_paper = 1, repeat_combined = 1;
    double lambda = 1e-3;

    explicit Options(Config& c) {
        c.read("dataset", dataset, check_light_field_shape);
        c.read("sides", sides, limits::map_side);
        c.read("images", images, image_counts);
        c.read("time_side", time_side, limits::map_side);
        c.read("iterations", iterations, limits::some_iterations);
        c.read("rounds", rounds, limits::repetitions);
        c.read("repeat_cpu", repeat_cpu, limits::repetitions);
        c.read("repeat_paper", repeat_paper, limits::repetitions);
        c.read("repeat_combined", repeat_combined, limits::repetitions);
        c.read("lambda", lambda, limits::weight);
        c.finish();
        if (sides.size() < 3) c.reject("sides", "a slope needs at least 3");
        if (images.size() < 3) c.reject("images", "a slope needs at least 3");
    }
    /// The paper's conjugate gradients with surface and view maps of one side.
    FitRequest request(int side) const {
        FitRequest r;
        r.set("mode", "paper");
        r.model.surface_side = r.model.view_side = side;
        r.model.lambda_surface = r.model.lambda_view = float(lambda);
        r.iterations = iterations;
        return r;
    }
};

struct Memory {
    std::string passes, storage;
    int side;
    uint64_t parameters = 0, planned = 0, allocated = 0, paper_layout = 0;
};

Memory memory_of(const Dataset& dataset, const FitRequest& request) {
    const TriangleAtlas atlas(dataset.mesh, request.model.surface_side);
    const VertexRings rings(dataset.mesh);
    Memory m{.passes = request.text("passes"), .storage = request.text("storage"), .side = request.model.surface_side};
    m.planned = total_bytes(plan(dataset, request).memory);
    m.paper_layout = total_bytes(paper_layout(dataset.mesh.triangle_count(), dataset.mesh.vertex_count(),
                                              request.model.surface_side, request.model.view_side));
    const auto context = Context::create(request.context);
    const FragmentEngine engine(dataset, atlas, rings, dataset.split(false), request.model_options(),
                                request.fragment_options());
    m.parameters = engine.layout().parameter_count();
    m.allocated = engine.bytes();
    return m;
}

/// The fastest iteration of a fit: all do the same work, and what else the machine does only adds to it.
double seconds_per_iteration(const Trace& trace) {
    double least = 1e300;
    for (size_t i = 1; i < trace.rows.size(); ++i)
        least = std::min(least, trace.rows[i].time_s - trace.rows[i - 1].time_s);
    return least;
}

struct Time {
    std::string engine, renderer;
    size_t images;
    uint64_t samples, parameters;
    double seconds;
};

/// An engine and how often it takes each image.
struct Contestant {
    std::string name, engine, passes;
    int repeat;
};

std::vector<Time> times_of(Experiment& experiment, const Dataset& dataset, const Options& o) {
    const FitRequest defaults = o.request(o.time_side);
    const TriangleAtlas atlas(dataset.mesh, o.time_side);
    const Contestant contestants[] = {{"cpu", "cpu", defaults.text("passes"), o.repeat_cpu},
                                      {"fragment paper", "fragment", "paper", o.repeat_paper},
                                      {"fragment combined", "fragment", "combined", o.repeat_combined}};
    const auto time_of = [&](const Contestant& c, int count) {
        const std::vector<uint32_t> some = spread_views(dataset.split(false), count);
        std::vector<uint32_t> views;
        for (uint32_t view : some) views.insert(views.end(), size_t(c.repeat), view);
        const SharedSamples once = distribute(dataset, atlas, defaults, some);
        FitRequest request = defaults;
        request.set("engine", c.engine);
        request.set("passes", c.passes);
        const FitOutcome out = solve(dataset, request, nullptr, {}, &views);
        note_gl(out, experiment.record());
        return Time{c.name,
                    out.gl_renderer.empty() ? experiment.cpu_name() : out.gl_renderer,
                    views.size(),
                    uint64_t(c.repeat) * once.list.samples.size(),
                    uint64_t(out.fit.parameters.size()) / 4 * 3,
                    seconds_per_iteration(out.trace)};
    };
    std::vector<Time> times;
    for (int round = 0; round < o.rounds; ++round) {  // what slows the machine for a while meets all sizes
        size_t at = 0;
        for (const Contestant& c : contestants)
            for (int count : o.images) {
                const Time time = time_of(c, count);
                if (round == 0) times.push_back(time);
                times[at].seconds = std::min(times[at].seconds, time.seconds);
                ++at;
            }
    }
    for (const Time& time : times)
        log_info(fmt::format("{}, {} images: {:.4f} s per iteration", time.engine, time.images, time.seconds));
    return times;
}

void scaling(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const size_t training = dataset.split(false).size();
    for (const int count : o.images)
        if (size_t(count) > training)
            experiment.config().reject(
                "images", fmt::format("holds {}, but {} has {} training views", count, dataset.name, training));
    std::vector<Memory> memory;
    for (const char* passes : {"paper", "combined"})
        for (const char* storage : {"fp32", "fp16"})
            for (int side : o.sides) {
                FitRequest request = o.request(side);
                request.set("engine", "fragment");
                request.set("source", "disk");  // images are not part of the engine's memory
                request.set("passes", passes);
                request.set("storage", storage);
                memory.push_back(memory_of(dataset, request));
            }
    const std::vector<Time> times = times_of(experiment, dataset, o);

    const std::string renderer = times.back().renderer;
    ResultFolder results = experiment.open_results(renderer);
    Lines bytes, seconds;
    CsvWriter memory_rows(results.path() / "memory.csv", {"engine", "storage", "passes", "side", "parameters",
                                                          "planned_bytes", "allocated_bytes", "paper_layout_bytes"});
    Table table({"engine", "side of maps", "parameters", "plan", "allocated", "Section 6.3's accounting"});
    const auto megabytes = [](uint64_t b) { return fmt::format("{:.2f} MB", double(b) / 1e6); };
    for (const Memory& m : memory) {
        memory_rows.row({"fragment", m.storage, m.passes, std::to_string(m.side), std::to_string(m.parameters),
                         std::to_string(m.planned), std::to_string(m.allocated), std::to_string(m.paper_layout)});
        const std::string name = fmt::format("fragment {} {}", m.passes, m.storage);
        table.add({name, std::to_string(m.side), std::to_string(m.parameters), megabytes(m.planned),
                   megabytes(m.allocated), megabytes(m.paper_layout)});
        bytes[name].emplace_back(double(m.parameters), double(m.allocated));
    }
    CsvWriter time_rows(results.path() / "time.csv",
                        {"engine", "images", "samples", "parameters", "seconds_per_iteration", "renderer"});
    for (const Time& t : times) {
        time_rows.row({t.engine, std::to_string(t.images), std::to_string(t.samples), std::to_string(t.parameters),
                       fmt::format("{:.6f}", t.seconds), t.renderer});
        seconds[t.engine].emplace_back(double(t.samples), t.seconds);
    }
    CsvWriter slope_rows(results.path() / "slopes.csv", {"of", "engine", "slope"});
    Table slopes({"slope of log", "engine", ""});
    const auto write_slopes = [&](const char* of, const char* over, const Lines& lines) {
        for (const auto& [engine, points] : lines) {
            const std::string slope = fmt::format("{:.3f}", log_slope(points));
            slope_rows.row({of, engine, slope});
            slopes.add({fmt::format("{} over {}", of, over), engine, slope});
        }
    };
    write_slopes("bytes", "parameters", bytes);
    write_slopes("seconds", "samples", seconds);
    memory_rows.commit();
    time_rows.commit();
    slope_rows.commit();
    results.commit();
    log_info("memory, the same for either optimizer\n" + table.text());
    log_info("slopes\n" + slopes.text());
    experiment.draw(results, fmt::format("{} ({} scale); OpenGL: {}; CPU: {}", dataset.name, experiment.profile(),
                                         renderer, experiment.cpu_name()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("scaling", argc, argv, radiafit::scaling); }
