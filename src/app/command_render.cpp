// render: how a fit looks.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>

#include "app/choose.h"
#include "app/commands.h"
#include "app/family.h"
#include "app/limits.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "base/output_lock.h"
#include "capture/png_file.h"
#include "eval/render.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

struct RenderOptions {
    std::string fit, output, dataset;
    std::optional<int> view;
    int turntable = 0;
    std::string all;            ///< of which split every view is shown; empty: one
    std::vector<double> light;  ///< direction, or empty
    std::optional<int> pixel_points;
    bool problems = false;
};

/// Whether render made it: its files say so in their first bytes, but for the PNG that gnuplot draws beside an SVG.
bool carries_mark(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return false;
    std::ifstream stream(file, std::ios::binary);
    std::string head(1 << 14, '\0');
    stream.read(head.data(), std::streamsize(head.size()));
    return head.find(picture_mark) != std::string::npos;
}

/// The pictures of one command. They are made under hidden names and appear together, over earlier ones of render and
/// over nothing else.
class Pictures {
public:
    explicit Pictures(const fs::path& folder) : folder_(folder), files_(folder) {}

    /// Refuses a name at which one of `endings` stands and is not render's: a fit's own map, a photograph.
    void check(const std::string& name, std::initializer_list<const char*> endings) {
        for (const char* ending : endings) {
            checked_.push_back({folder_ / (name + ending), folder_ / (name + ".svg")});
            check(checked_.back());
        }
    }
    void add(const std::string& name, const LightImage& image) {
        write_light_exr(files_.path() / (name + ".exr"), image);
        add(name, to_bytes(image));
        messages_.push_back(fmt::format("{0}.png, {0}.exr", (folder_ / name).string()));
    }
    void add_sheet(const std::string& name, const ByteImage& sheet, const std::string& content) {
        add(name + "_sheet", sheet);
        messages_.push_back(fmt::format("{}_sheet.png: {}", (folder_ / name).string(), content));
    }
    void add(const std::string& name, const ProblemPicture& picture) {
        draw_problems(picture, files_.path() / name);
        messages_.push_back(fmt::format("{0}.png, {0}.svg", (folder_ / name).string()));
    }
    void commit() {
        for (const Place& place : checked_) check(place);  // again: something may stand there by now
        files_.commit();
        for (const std::string& message : messages_) log_info(message);
    }

private:
    struct Place {
        fs::path file, drawing;  ///< drawing: an SVG of the same name
    };
    static void check(const Place& place) {
        std::error_code error;
        if (!fs::exists(fs::symlink_status(place.file, error)) || carries_mark(place.file)) return;
        if (place.file.extension() == ".png" && carries_mark(place.drawing)) return;
        throw UserError(
            fmt::format("{}: stands there and is no picture of radiafit render; choose another name or remove it",
                        place.file.string()));
    }
    void add(const std::string& name, const ByteImage& bytes) const {
        write_png(files_.path() / (name + ".png"), bytes.width, bytes.height, bytes.rgb, picture_mark);
    }

    fs::path folder_;
    AtomicFiles files_;
    std::vector<Place> checked_;
    std::vector<std::string> messages_;
};

/// Where one view goes: FILE.png, FILE.exr and FILE.svg alike name FILE.
fs::path stem_of(const std::string& output) {
    fs::path stem = output;
    for (const char* extension : {".png", ".exr", ".svg"})
        if (stem.extension() == extension) return stem.replace_extension();
    return stem;
}

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

/// The view that was asked for, or one from the middle of those held out.
uint32_t chosen_view(const Dataset& dataset, std::optional<int> view) {
    if (view) {
        if (*view < 0 || size_t(*view) >= dataset.views.size())
            throw UserError(
                fmt::format("--view {}: {} has views 0 to {}", *view, dataset.name, dataset.views.size() - 1));
        return uint32_t(*view);
    }
    const auto held_out = dataset.split(true);
    return held_out.empty() ? 0 : held_out[held_out.size() / 2];
}

/// A distant lamp in this direction, of any length.
Light lamp_towards(const std::vector<double>& xyz) {
    const Vec3d direction(xyz[0], xyz[1], xyz[2]);
    const double length = direction.norm();
    if (!(std::isfinite(length) && length > 0))
        throw UserError(fmt::format("--light {}: a direction's length is finite and not 0; choose, say, 0,0.6,0.8",
                                    fmt::join(xyz, ",")));
    return {Light::Kind::distant, direction / length, Vec3d::Ones()};
}

std::string turn_name(int i) { return fmt::format("turn{:03d}", i); }

void render_turntable(const RenderOptions& o, Fitted& fitted, View shown) {
    const Dataset& dataset = fitted.dataset();
    const Contestant fit = fitted.contestant();
    const int points = o.pixel_points.value_or(as_photographed);
    if (dataset.has_grid()) throw UserError("--turntable: a grid is seen from where its camera stood");
    Pictures pictures(o.output);
    for (int i = 0; i < o.turntable; ++i) pictures.check(turn_name(i), {".png", ".exr"});
    for (int i = 0; i < o.turntable; ++i) {
        shown.camera = turntable_camera(dataset, i, o.turntable);
        pictures.add(turn_name(i), render(fit, dataset, shown, points));
    }
    pictures.commit();
}

/// Where a view lies so far from the images that were fitted that it shows less than the whole fit.
void tell_share(const Contestant& fit, const View& shown) {
    const double share = fit.share_of_fit ? fit.share_of_fit(shown) : 1;
    if (share < 1)
        log_warning(
            fmt::format("lamp or camera are far from those of the training images: the picture shows {:.0f} % of the "
                        "fit, the rest is Lambertian",
                        100 * share));
}

ByteImage sheet_of(const Contestant& fit, const Contestant& baseline, const Dataset& dataset, uint32_t view,
                   int points) {
    const JudgedView trivial = judged_view(baseline, dataset, view, points);
    return comparison_sheet(judged_view(fit, dataset, view, points), &trivial, dataset.encoding);
}
std::string sheet_content(Fitted& fitted, uint32_t view) {
    return fmt::format("photograph {}, {}, fit, 4 x |error|", fitted.dataset().views[view].name,
                       fitted.baseline_name());
}

/// `shown`: view `view`, perhaps under another lamp: only as it was photographed can it be compared.
void render_view(const RenderOptions& o, Fitted& fitted, uint32_t view, const View& shown) {
    const Dataset& dataset = fitted.dataset();
    const Contestant fit = fitted.contestant();
    const int points = o.pixel_points.value_or(as_photographed);
    const fs::path stem = stem_of(o.output);
    const std::string name = stem.filename().string();
    Pictures pictures(stem.parent_path());
    pictures.check(name, {".png", ".exr", "_sheet.png"});
    tell_share(fit, shown);
    pictures.add(name, render(fit, dataset, shown, points));
    if (o.light.empty()) {
        const auto trivial = fitted.baseline();
        pictures.add_sheet(name, sheet_of(fit, trivial->contestant(), dataset, view, points),
                           sheet_content(fitted, view));
    }
    pictures.commit();
}

/// Every view of a split, into a folder, each beside its photograph.
void render_all(const RenderOptions& o, Fitted& fitted) {
    const Dataset& dataset = fitted.dataset();
    const bool held_out = choose<bool>("all", o.all, {{"held-out", true}, {"train", false}});
    const std::vector<uint32_t> views = dataset.split(held_out);
    if (views.empty()) throw UserError(fmt::format("--all {}: {} has no such view", o.all, dataset.name));
    const auto name_of = [](uint32_t view) { return fmt::format("view{:04d}", view); };
    const Contestant fit = fitted.contestant();
    const auto trivial = fitted.baseline();
    const Contestant baseline = trivial->contestant();
    const int points = o.pixel_points.value_or(as_photographed);
    Pictures pictures(o.output);
    for (const uint32_t view : views) pictures.check(name_of(view), {".png", ".exr", "_sheet.png"});
    Progress progress("render", views.size());
    for (const uint32_t view : views) {
        pictures.add(name_of(view), render(fit, dataset, dataset.views[view], points));
        pictures.add_sheet(name_of(view), sheet_of(fit, baseline, dataset, view, points), sheet_content(fitted, view));
        progress.advance();
    }
    progress.finish();
    pictures.commit();
}

void render_problems(const RenderOptions& o, Fitted& fit) {
    const auto picture = fit.problems();
    if (!picture)
        throw UserError("--problems: those of a light field map are vertices, with no place of their own on a picture");
    const fs::path stem = stem_of(o.output);
    Pictures pictures(stem.parent_path());
    pictures.check(stem.filename().string(), {".png", ".svg"});
    pictures.add(stem.filename().string(), *picture);
    pictures.commit();
}

void check_output(const RenderOptions& o) {
    if (o.output.empty()) throw UserError("--output is empty; name a file, or a folder for --turntable and --all");
    const fs::path name = stem_of(o.output).filename();
    if (o.turntable == 0 && o.all.empty() && (name.empty() || name == "." || name == ".."))
        throw UserError(fmt::format("--output {}: names a folder; name a file in it", o.output));
}

void render_fit(const RenderOptions& o) {
    check_output(o);
    check_pixel_points(o.pixel_points);
    const OutputLock lock(stem_of(o.output));
    const auto fit = open_fit(o.fit, o.dataset);
    if (!o.light.empty() && !fit->takes_light())
        throw UserError("--light: a light field map keeps the light it was photographed under");
    if (o.problems) return render_problems(o, *fit);
    if (!o.all.empty()) return render_all(o, *fit);
    const Dataset& dataset = fit->dataset();
    const uint32_t view = chosen_view(dataset, o.view);
    View shown = dataset.views[view];
    if (!o.light.empty()) shown.light = lamp_towards(o.light);
    if (o.turntable > 0) return render_turntable(o, *fit, shown);
    render_view(o, *fit, view, shown);
}

}  // namespace

void add_render(CommandLine& program) {
    auto o = std::make_shared<RenderOptions>();
    CommandLine& command = program.add_command("render", "a view of a fit as EXR and PNG, beside the photograph");
    command.add_text("fit", o->fit, "folder of the fit").required();
    command.add_number("--view", o->view, limits::view, "view index; default: a held-out one");
    command.add_number("--turntable", o->turntable, limits::turntable, "this many views around the object instead")
        .hide_default()
        .excludes("--view");
    command.add_word("--all", o->all, "held-out or train: every such view, into a folder, each beside its photograph")
        .choices({"held-out", "train"})
        .hide_default()
        .excludes("--view")
        .excludes("--turntable");
    command
        .add_numbers("--light", o->light, 3, "x y z: direction to a distant lamp of intensity 1, of a reflectance fit")
        .excludes("--all");
    command
        .add_flag("--problems", o->problems,
                  "how each texel's fit ended, its iterations, samples and error, in the atlas, of a reflectance fit")
        .excludes("--view")
        .excludes("--light")
        .excludes("--turntable")
        .excludes("--all");
    command.add_text("--dataset", o->dataset, "where the dataset is now, if it moved");
    add_pixel_points(command, o->pixel_points);
    command
        .add_text("-o,--output", o->output, "file name without or with extension; a folder for --turntable and --all")
        .required();
    command.on_run([=] { render_fit(*o); });
}

}  // namespace radiafit
