// radiafit-bench: this machine's devices, checked against sums in double and timed. See docs/gpu.md.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/failure.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/program.h"
#include "base/record.h"
#include "base/standard_streams.h"
#include "base/time_limit.h"
#include "base/wording.h"
#include "bench/all.h"
#include "bench/bundle.h"
#include "bench/datasets.h"
#include "bench/light_field_scene.h"
#include "bench/options.h"
#include "bench/rows.h"
#include "bench/texel_scene.h"
#include "dataset/checksums.h"
#include "gl/driver_advice.h"

namespace radiafit::harness {
namespace {

void list_all() {
    fmt::print("cpu: {} threads\n", thread_count());
    const auto ask = [](const DeviceInfo& d) -> std::string {
        try {
            const auto context = Context::create({.kind = d.kind, .device = d.device});
            return fmt::format("{}, OpenGL {}", context->renderer(), context->version());
        } catch (const std::exception& e) {
            return e.what();
        }
    };
    bool found = false;
    for (const auto& [device, text, failure] : ask_each_device(ask)) {
        const std::string name = device.kind == ContextKind::osmesa ? "--platform osmesa"
                                 : device.device < 0                ? "EGL"
                                                                    : fmt::format("--gpu {}", device.device);
        fmt::print("{}: {} ({})\n", name, failure.empty() ? text : failure, device.description);
        found |= failure.empty() && !device.software;
    }
    const ChipSigns signs = look_for_chip();
    if (!found && !signs.advice.empty()) fmt::print("no graphics chip by OpenGL: {}\n", signs.advice);
}

/// Null where no device needs a context. Throws UserError where a chip exists but could not be used, and software was
/// not asked for.
std::unique_ptr<Context> open_context(const BenchOptions& options) {
    if (std::ranges::none_of(options.devices, needs_opengl)) return nullptr;
    auto context = Context::create(options.context);
    if (!context->software() || options.chosen_renderer) return context;
    const ChipSigns signs = look_for_chip();
    if (signs.nvidia)
        throw UserError(fmt::format("OpenGL finds {} alone: {}. To time that all the same, say --platform osmesa",
                                    context->renderer(), signs.advice));
    if (!signs.advice.empty()) log_warning(fmt::format("OpenGL finds {} alone: {}", context->renderer(), signs.advice));
    return context;
}

struct NamedScene {
    std::string name;
    std::unique_ptr<BenchScene> scene;
};

std::vector<NamedScene> make_scenes(const std::vector<Dataset>& datasets, bool by_opengl) {
    std::vector<NamedScene> scenes;
    for (const Dataset& dataset : datasets)
        scenes.push_back({dataset.name, dataset.light_moves() ? texel_scene(dataset, by_opengl)
                                                              : light_field_scene(dataset, by_opengl)});
    return scenes;
}

/// Null where the device does not agree, or does not run.
std::unique_ptr<TimedDevice> check(BenchScene& scene, const ExactSums& exact, const std::vector<double>& reference,
                                   Checked& checked) {
    try {
        checked.sums = compare(scene.sums(checked.device), exact);
        auto contestant = scene.contestant(checked.device);
        checked.fit_difference = fit_difference(contestant->fit(BenchScene::fit_iterations), reference);
        checked.fit_tolerance = scene.fit_tolerance();
        if (checked.disagreement().empty()) {
            if (checked.sums.takes_others())
                log_warning(fmt::format(
                    "{} on {} took {} samples more or fewer than the list, of {}: its rasterizer rounds "
                    "otherwise; it is timed, and marked",
                    name_of(checked.device), checked.scene, checked.sums.other_samples, checked.sums.samples));
            return contestant;
        }
    } catch (const std::exception& e) {
        checked.failure = describe(e).line;
    }
    log_warning(fmt::format("{} on {} {} and is not timed: {}", name_of(checked.device), checked.scene,
                            checked.failure.empty() ? "disagrees with the CPU in double" : "does not run",
                            checked.disagreement()));
    return nullptr;
}

/// Checks each device on each scene; those that agree are ready to be timed.
void check_all(std::vector<NamedScene>& scenes, const std::vector<Device>& devices, BenchResults& results) {
    for (auto& [name, scene] : scenes) {
        log_info(fmt::format("checking {}", name));
        const ExactSums exact = scene->exact_sums();
        const std::vector<double> reference = scene->reference_fit();
        for (const Device device : devices) {
            if (!scene->has(device)) continue;
            Checked& checked = results.checked.emplace_back(Checked{.scene = name, .device = device});
            if (auto contestant = check(*scene, exact, reference, checked))
                results.timed.push_back({name, device, std::move(contestant)});
        }
    }
}

void time_all(const BenchOptions& options, BenchResults& results) {
    log_info("warming up");
    for (Timed& timed : results.timed) warm_up(timed);
    for (int r = 0; another_round(r, options.repetitions); ++r) {
        results.peaks.push_back(measure_peaks(options.devices));
        measure_round(results.timed);
        log_info(fmt::format("repetition {} of {}", r + 1, options.repetitions));
    }
}

JsonFields config_of(const BenchOptions& options) {
    std::string devices;
    for (const Device device : options.devices)
        devices += fmt::format("{}{}", devices.empty() ? "" : ", ", json_string(name_of(device)));
    return {{"scale", json_string(options.scale)},
            {"devices", "[" + devices + "]"},
            {"repetitions", std::to_string(options.repetitions)},
            {"platform", json_string(to_string(options.context.kind))},
            {"gpu", std::to_string(options.context.device)}};
}

/// Repetitions of a run that others are held against.
constexpr int enough = 9;
/// Under which runs are kept and compared, whatever the program's file is called.
constexpr const char* experiment = "bench";

Record record_of(Record record, const BenchOptions& options, const std::vector<Dataset>& datasets,
                 const Context* context) {
    record.program = experiment;
    record.config = config_of(options);
    record.more = {{"profile", json_string(options.scale)},
                   {"standard", options.every_device && options.repetitions >= enough ? "true" : "false"}};
    for (const Dataset& dataset : datasets) record.datasets->push_back(dataset_note(dataset));
    if (!context) return record;
    record.gl_vendor = context->vendor();
    record.gl_renderer = context->renderer();
    record.gl_version = context->version();
    return record;
}

/// Named as experiments name it: a software renderer's times are those of the processor.
std::string folder_of(const Context* context, const Record& record) {
    if (!context) return fmt::format("{}, {} threads", record.cpu, thread_count());
    return context->software() ? context->renderer() + ", " + record.cpu : context->renderer();
}

/// Throws UserError for a folder that can't be written, before any work is done.
void require_writable(const std::filesystem::path& folder) { const AtomicFolder probe(folder / "probe"); }

/// Exit status: 1 if some device disagrees or does not run.
int bench(const BenchOptions& options, const Record& started) {
    require_writable(options.output / experiment);
    const auto context = open_context(options);
    const BenchDatasets datasets(options.scale);
    const Record record = record_of(started, options, datasets.all(), context.get());
    ResultFolder folder(options.output, experiment, folder_of(context.get(), record), record);
    std::vector<NamedScene> scenes = make_scenes(datasets.all(), context != nullptr);
    BenchResults results{.renderer = record.gl_renderer, .processor = fmt::format("cpu, {} threads", thread_count())};
    if (context) results.halves = measure_half_rounding();
    for (const auto& [name, scene] : scenes) results.scenes.emplace_back(name, scene->facts());
    check_all(scenes, options.devices, results);
    fmt::print("{}\n", agreement_table(results.checked));
    std::fflush(stdout);  // what follows may take long
    time_all(options, results);
    if (results.peaks.size() < size_t(enough))
        for (auto& [key, value] : folder.record().more)
            if (key == "standard") value = "false";
    fmt::print("{}\n", time_table(results));
    write_rows(results, folder);
    folder.commit();
    finish_standard_output();
    log_info("rows: " + folder.path().string());
    return results.timed.size() == results.checked.size() ? 0 : 1;
}

/// As open_context() does, in a process of its own.
void require_renderer(const BenchOptions& options) {
    constexpr unsigned patience_s = 60;
    const Ended ended = run_apart(
        [&]() -> std::string {
            try {
                open_context(options);
                return "";
            } catch (const UserError& e) {
                return e.what();
            }
        },
        patience_s);
    if (ended.status == 0 && !ended.output.empty()) throw UserError(ended.output);
}

/// Where it is called as one of its experiments: --part NAME, and that one's own options.
int run_part(int argc, const char* const* argv) {
    for (const BundledExperiment& e : bundled_experiments())
        if (std::string_view(argv[2]) == e.name) return e.main(argc - 2, argv + 2);
    throw UserError(fmt::format("--part {}: there is no such experiment", argv[2]));
}

int run(int argc, const char* const* argv) {
    if (argc > 2 && std::string_view(argv[1]) == "--part") return run_part(argc, argv);
    const auto options = parse_bench_options(argc, argv);
    if (!options) return 0;
    if (options->all) require_renderer(*options);
    if (options->all) return measure_all(*options, "/proc/self/exe", bundled_experiments());
    if (options->minutes > 0) limit_time(options->minutes);
    if (!options->list) return bench(*options, make_record(argc, argv));
    list_all();
    finish_standard_output();
    return 0;
}

}  // namespace
}  // namespace radiafit::harness

/// Exit status: 0 done, 1 a device disagrees or the machine failed, 2 the user's mistake.
int main(int argc, char** argv) {
    using namespace radiafit;
    name_options_by_flag(
        {{"context", "platform"}, {"device", "gpu"}, {"`radiafit devices`", "`radiafit-bench --list`"}});
    prepare_standard_streams();
    try {
        return radiafit::harness::run(argc, argv);
    } catch (const Interrupted& interrupted) {
        end_interrupted("radiafit-bench", interrupted);
    } catch (const std::exception& e) {
        const Failure failure = describe(e);
        log_error("radiafit-bench", standard_output_failed() ? standard_output_failure() : failure.line);
        return standard_output_failed() ? 1 : failure.status;
    }
}
