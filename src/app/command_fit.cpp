// fit, judge, render.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/choices.h"
#include "app/commands.h"
#include "app/solver.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/record.h"
#include "capture/image_file.h"
#include "eval/judge.h"
#include "eval/render.h"

namespace radiafit {

void add_fit_options(CLI::App& c, FitRequest& r) {
    std::string known;
    for (const Solver& s : solvers()) known += fmt::format("{}{}: {}", known.empty() ? "" : "; ", s.name, s.help);
    c.add_option("--solver", r.solver, known)->capture_default_str();
    c.add_option("--engine", r.engine, "cpu or fragment")->capture_default_str();
    c.add_option("--optimizer", r.optimizer, "cg or sd")->capture_default_str();
    c.add_option("--mode", r.mode, "paper or modern")->capture_default_str();
    c.add_option("--passes", r.passes, "paper or combined, of the fragment engine")->capture_default_str();
    c.add_option("--storage", r.storage, "fp32, fp16 or fp16-truncate, of the fragment engine")->capture_default_str();
    c.add_option("--sums", r.sums, "fp32 or fp16: sums over samples, of the fragment engine")->capture_default_str();
    c.add_option("--distributor", r.distributor, "gl or cpu, for engines that read a sample list")
        ->capture_default_str();
    c.add_option("--source", r.source,
                 "disk, disk-cold (past the page cache), memory, or device (kept there), of engines that stream images")
        ->capture_default_str();
    c.add_option("--view", r.view, "nearest or bilinear look-up in view maps")->capture_default_str();
    c.add_option("--space", r.space, "stored or linear: what residuals are formed in")->capture_default_str();
    c.add_option("--terms", r.model.terms, "K")->capture_default_str();
    c.add_flag("--deflate,!--joint", r.deflate, "fit terms one after another, or together (default)");
    c.add_option("--surface-side", r.model.surface_side, "n: n(n+1)/2 texels per surface map")->capture_default_str();
    c.add_option("--view-side", r.model.view_side, "m: m x m texels per view map")->capture_default_str();
    c.add_option("--lambda-surface", r.model.lambda_surface, "smoothness of surface maps")->capture_default_str();
    c.add_option("--lambda-view", r.model.lambda_view, "smoothness of view maps")->capture_default_str();
    c.add_option("--mu", r.mu, "weight of the bounds; default: 1, in paper mode 1e-4");
    c.add_option("--iterations", r.iterations, "at most")->capture_default_str();
    c.add_option("--stop-residual", r.stop_residual, "stop a problem at this root mean square residual; 0 is off")
        ->capture_default_str();
    c.add_option("--stop-change", r.stop_output_change, "stop a problem when its output changes less; 0 is off")
        ->capture_default_str();
    c.add_option("--seed", r.seed, "of the start values of further terms")->capture_default_str();
    c.add_option("--record", r.record, "compact or full (the paper's): what two-step writes of a sample")
        ->capture_default_str();
    c.add_option("--memory", r.memory, "bytes of samples that two-step's distribution holds at a time, such as 64M")
        ->capture_default_str();
    c.add_option("--records", r.records, "folder to keep two-step's records in, or to find them");
    c.add_option("--refills", r.refills,
                 "how often pca replaces entries that it had to invent by what its terms say, and refines the terms")
        ->capture_default_str();
    std::string settings;
    for (const CeresSetting& s : ceres_settings())
        settings += fmt::format("{}{}: {}", settings.empty() ? "" : "; ", s.name, s.help);
    c.add_option("--ceres", r.ceres, settings)->capture_default_str();
    c.add_option("--context", r.context, "egl or osmesa")->capture_default_str();
    c.add_option("--device", r.device, "EGL device index, see radiafit devices; -1 chooses")->capture_default_str();
}

LightFieldFit baseline_of(const LightFieldFit& fit, const Dataset& dataset) {
    FitRequest mean;
    mean.solver = "mean";
    mean.space = fit.space == TargetSpace::linear ? "linear" : "stored";
    mean.model = fit.options;
    return solve(dataset, mean).fit;
}

namespace {

void print_judgement(const JudgeResult& fit, const JudgeResult& baseline) {
    fmt::print("{} views ({}): PSNR {:.2f} dB, APE {:.2f}; mean colour per texel: PSNR {:.2f} dB, APE {:.2f}\n",
               fit.images.size(), to_string(fit.split), fit.psnr(), fit.ape(), baseline.psnr(), baseline.ape());
}

Split choose_split(const std::string& name) {
    if (name == "train") return Split::train;
    if (name == "test") return Split::test;
    throw UserError("split '" + name + "' does not exist; choose train or test");
}

/// Throws UserError if the fit's folder and the records' lie one inside the other.
void check_apart(const std::string& output, const std::string& records) {
    if (records.empty()) return;
    const auto whole = [](const std::string& path) {
        return (std::filesystem::weakly_canonical(path) / "").lexically_normal().string();
    };
    const std::string a = whole(output), b = whole(records);
    if (a.starts_with(b) || b.starts_with(a))
        throw UserError(
            fmt::format("{}: the records' folder and the fit's lie one inside the other; choose another", records));
}

/// Everything run_fit leaves, in one folder.
void save(const std::string& folder, const Dataset& dataset, const FitRequest& request, FitOutcome& outcome,
          const Invocation& invocation) {
    Record record = make_record(invocation.argc, invocation.argv);
    record.gl_vendor = outcome.gl_vendor;
    record.gl_renderer = outcome.gl_renderer;
    record.gl_version = outcome.gl_version;
    outcome.fit.provenance_json = record_json(record);
    const FitTimes& t = outcome.times;
    nlohmann::ordered_json times = {
        {"distribution_s", t.distribution},
        {"streaming_s", t.streaming},
        {"optimization_s", t.optimization},
        {"total_s", t.total},
        {"sweep_cpu_ms_per_image", outcome.sweep_cpu_ms_per_image},
        {"unaccounted_s", t.total - t.distribution - t.streaming - t.optimization},
    };
    if (request.solver == "two-step")
        times["records"] = {
            {"bytes_written", outcome.records.bytes_written}, {"waiting_bytes_read", outcome.records.bytes_read},
            {"waiting_parts", outcome.records.waiting_parts}, {"bytes_read", outcome.record_bytes_read},
            {"cached_share", outcome.record_cached_share},    {"sample_iterations", outcome.sample_iterations},
            {"working_set_bytes", outcome.working_set_bytes},
        };
    if (const ResamplingCounts& r = outcome.resampling; r.entries)
        times["resampling"] = {
            {"entries", r.entries},
            {"outside_hull", r.outside_hull},
            {"unseen_texels", r.unseen_texels},
            {"invented_share", r.invented_share()},
        };
    outcome.fit.times_json = times.dump();
    write_fit(folder, outcome.fit, dataset.mesh, [&](const std::filesystem::path& inside) {
        write_file(inside / "trace.csv", trace_csv(outcome.trace, request.label(), outcome.fit.engine));
    });
}

struct RenderOptions {
    std::string fit, output;
    int view = -1, turntable = 0;
};

/// A camera on a circle around the mesh, as far away and as high as the capture's cameras are on average.
Camera turntable_camera(const Dataset& dataset, int i, int count) {
    Vec3d center = Vec3d::Zero(), up = Vec3d::Zero();
    for (const Vec3f& p : dataset.mesh.positions) center += p.cast<double>() / double(dataset.mesh.vertex_count());
    double distance = 0, height = 0;
    for (const View& v : dataset.views) up -= v.camera.cam_from_world_rotation.row(1).transpose();
    up.normalize();
    for (const View& v : dataset.views) {
        const Vec3d d = v.camera.center() - center;
        distance += d.norm() / double(dataset.views.size());
        height += up.dot(d.normalized()) / double(dataset.views.size());
    }
    const Vec3d any = std::abs(up.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
    const Vec3d east = any.cross(up).normalized(), north = up.cross(east);
    const double angle = 2 * 3.14159265358979 * i / count, flat = std::sqrt(std::max(0.0, 1 - height * height));
    const Vec3d eye = center + distance * (height * up + flat * (std::cos(angle) * east + std::sin(angle) * north));
    const Camera& like = dataset.views[0].camera;
    Camera camera =
        Camera::look_at(eye, center, up, 2 * std::atan(0.5 * like.height / like.fy), like.width, like.height);
    return camera;
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw UserError(fmt::format("cannot write {}: {}; choose a writable folder", folder.string(), error.message()));
}

void write_light(const std::filesystem::path& stem, const LightImage& image) {
    write_light_exr(stem.string() + ".exr", image);
    const ByteImage bytes = to_bytes(image);
    write_png(stem.string() + ".png", bytes.width, bytes.height, bytes.rgb);
    log_info(fmt::format("{0}.png, {0}.exr", stem.string()));
}

void render(const RenderOptions& o) {
    const StoredFit stored = read_fit(o.fit);
    const LightFieldFit& fit = stored.fit;
    const Dataset dataset = open_fitted_dataset(fit);
    const std::filesystem::path out(o.output);
    if (o.turntable > 0) {
        make_folder(out);
        for (int i = 0; i < o.turntable; ++i)
            write_light(out / fmt::format("turn{:03d}", i),
                        render_fit(fit, dataset.mesh, turntable_camera(dataset, i, o.turntable)));
        return;
    }
    uint32_t view = 0;
    if (o.view >= 0) {
        if (size_t(o.view) >= dataset.views.size())
            throw UserError(
                fmt::format("--view {}: {} has views 0 to {}", o.view, dataset.name, dataset.views.size() - 1));
        view = uint32_t(o.view);
    } else {
        const auto held_out = dataset.split(true);
        view = held_out.empty() ? 0 : held_out[held_out.size() / 2];
    }
    const std::filesystem::path stem =
        out.extension() == ".png" || out.extension() == ".exr" ? std::filesystem::path(out).replace_extension() : out;
    if (!stem.parent_path().empty()) make_folder(stem.parent_path());
    write_light(stem, render_fit(fit, dataset.mesh, dataset.views[view].camera));
    const JudgedView baseline = judged_view(baseline_of(fit, dataset), dataset, view);
    const ByteImage sheet = comparison_sheet(judged_view(fit, dataset, view), &baseline, dataset.encoding);
    write_png(stem.string() + "_sheet.png", sheet.width, sheet.height, sheet.rgb);
    log_info(fmt::format("{}_sheet.png: photograph {}, mean colour per texel, fit, 4 x |error|", stem.string(),
                         dataset.views[view].name));
}

}  // namespace

void add_fit(CLI::App& app, const Invocation& invocation) {
    auto request = std::make_shared<FitRequest>();
    auto folder = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("fit", "fit a model to a packed dataset");
    command->add_option("dataset", *folder, "packed dataset")->required();
    add_fit_options(*command, *request);
    command->add_option("-o,--output", *out, "folder of the fit")->required();
    command->callback([=] {
        request->check();
        reject_idle_options(*request);
        check_apart(*out, request->records);
        request->scratch = (std::filesystem::absolute(*out) / "").parent_path().parent_path();
        check_fit_target(*out);
        AtomicFolder(*out,
                     AtomicFolder::Existing::replace);  // an output that cannot be written shows now, not at the end
        const Dataset dataset = open_dataset(*folder);
        Progress progress("fit", size_t(request->iterations) + 1);
        FitOutcome outcome = solve(dataset, *request, nullptr, [&](int, const auto&) { progress.advance(); });
        progress.finish();
        save(*out, dataset, *request, outcome, invocation);
        const auto counts = outcome.fit.status_counts();
        std::string line = fmt::format("{} in {:.1f} s: ", request->label(), outcome.times.total);
        if (!outcome.trace.rows.empty())
            line += fmt::format("error {:.6g} -> {:.6g}, ", outcome.trace.rows.front().error,
                                outcome.trace.rows.back().error);
        if (const ResamplingCounts& r = outcome.resampling; r.entries)
            line += fmt::format("{} of {} resampled entries ({:.1f}%) invented, ", r.outside_hull + r.unseen_texels,
                                r.entries, 100 * r.invented_share());
        log_info(fmt::format("{}{} problems without samples, {} not finite; see {}", line,
                             counts[size_t(Status::no_samples)], counts[size_t(Status::not_finite)], *out));
    });
}

void add_judge(CLI::App& app) {
    struct Options {
        std::string fit, split = "test", dataset;
        bool json = false;
    };
    auto o = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("judge", "APE and PSNR of a fit, beside those of the trivial baseline");
    command->add_option("fit", o->fit, "folder of the fit")->required();
    command->add_option("--split", o->split, "train or test")->capture_default_str();
    command->add_option("--dataset", o->dataset, "where the dataset is now, if it moved");
    command->add_flag("--json", o->json, "one JSON object on standard output");
    command->callback([=] {
        const Split split = choose_split(o->split);
        if (o->json) set_quiet(true);
        const LightFieldFit fit = read_fit(o->fit).fit;
        const Dataset dataset = open_fitted_dataset(fit, o->dataset);
        const JudgeResult result = judge(fit, dataset, split);
        const JudgeResult baseline = judge(baseline_of(fit, dataset), dataset, split);
        if (o->json)
            fmt::print("{}\n", judge_json(result, &baseline));
        else
            print_judgement(result, baseline);
    });
}

void add_render(CLI::App& app) {
    auto o = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "a view of a fit as EXR and PNG, beside the photograph");
    command->add_option("fit", o->fit, "folder of the fit")->required();
    auto* view = command->add_option("--view", o->view, "view index; default: a held-out one");
    command->add_option("--turntable", o->turntable, "this many views around the object instead")
        ->excludes(view)
        ->check(CLI::Range(1, 10000));
    command->add_option("-o,--output", o->output, "file name without or with extension; a folder for --turntable")
        ->required();
    command->callback([=] { render(*o); });
}

}  // namespace radiafit
