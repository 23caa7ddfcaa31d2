// capture: the steps from photographs to a mesh that COLMAP does not do, and whether each step's outcome is good
// enough.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/log.h"
#include "base/parallel.h"
#include "capture/colmap.h"
#include "capture/mesh_file.h"
#include "cli/commands.h"
#include "dataset/mesh_ply.h"
#include "fitting/limits.h"
#include "stereo/dense.h"
#include "stereo/masks.h"
#include "stereo/mesh_check.h"
#include "stereo/mesh_cut.h"
#include "stereo/model_check.h"
#include "stereo/preview.h"
#include "stereo/stereo_folder.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* model_help = "folder of a COLMAP model of undistorted photographs, with its points";

/// Ends the command, with status 2, where an outcome is too poor to go on.
void judge(const std::vector<std::string>& poor, bool go_on) {
    if (poor.empty()) return;
    const std::string line = fmt::format("{}", fmt::join(poor, "; "));
    if (!go_on) throw UserError(line + "; --go-on goes on all the same");
    log_warning(line);
}

/// Names of masks are those of photographs, by several habits (capture/mask_names.h).
void require_images(const std::string& images, const std::string& masks) {
    if (!masks.empty() && images.empty())
        throw UserError("--masks needs --images, the folder of the photographs, whose names the masks have; give both");
}

void print_model(const ModelCheck& check, bool json) {
    if (!json) {
        fmt::print(
            "{} of {} photographs registered, {} points\nmean reprojection error {:.2f} pixels, mean track "
            "length {:.1f}\n",
            check.registered, check.photographs.size(), check.points, check.reprojection_error, check.track_length);
        for (const ModelCheck::Photograph& p : check.photographs)
            if (!p.registered) fmt::print("not registered: {}\n", p.name);
        return;
    }
    Json photographs = Json::array();
    for (const ModelCheck::Photograph& p : check.photographs)
        photographs.push_back({{"name", p.name}, {"registered", p.registered}, {"points", p.points}});
    fmt::print("{}\n", Json{{"registered", check.registered},
                            {"points", check.points},
                            {"reprojection_error", check.reprojection_error},
                            {"track_length", check.track_length},
                            {"poor", check.poor},
                            {"photographs", photographs}}
                           .dump(2));
}

void add_check_model(CommandLine& parent) {
    struct Options {
        std::string model, photographs;
        bool json = false, go_on = false;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command =
        parent.add_command("check-model", "whether enough photographs were registered, and how well");
    command.add_text("model", o->model, model_help).required();
    command.add_text("--images", o->photographs, "folder of all photographs, registered or not").required();
    command.add_flag("--go-on", o->go_on, "only warn of what is poor");
    add_json(command, o->json);
    command.on_run([=] {
        const ModelCheck check = check_model(o->model, o->photographs);
        judge(check.poor, o->go_on);
        print_model(check, o->json);
    });
}

void print_depths(const DenseReport& report, bool json) {
    size_t pixels = 0, matched = 0, agreed = 0;
    Json views = Json::array();
    for (const DenseReport::View& v : report.views) {
        pixels += v.pixels, matched += v.matched, agreed += v.agreed;
        views.push_back({{"name", v.name},
                         {"sources", v.sources},
                         {"pixels", v.pixels},
                         {"matched", v.matched},
                         {"agreed", v.agreed}});
    }
    if (json) return fmt::print("{}\n", Json{{"photographs", views}}.dump(2));
    const auto percent = [&](size_t count) { return 100 * double(count) / double(std::max<size_t>(pixels, 1)); };
    fmt::print(
        "{} depth maps; of the pixels that may show the object {:.0f} % have a depth, and {:.0f} % one that other "
        "photographs agree on\n",
        report.views.size(), percent(matched), percent(agreed));
}

void add_depths(CommandLine& parent) {
    auto o = std::make_shared<DenseOptions>();
    auto out = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    CommandLine& command = parent.add_command(
        "depths", "depth and normal maps of photographs, as COLMAP's stereo_fusion reads them, without a GPU");
    command.add_text("--model", o->model, model_help).required().input();
    command.add_text("--images", o->images, "folder of the undistorted photographs").required().input();
    command.add_number("--sources", o->sources, limits::dense_sources, "photographs that each is compared with");
    command.add_number("--agree", o->agree, limits::dense_agree, "photographs that have to agree on a depth");
    command.add_number(
        "--region", o->region, limits::dense_region,
        "where depths are looked for: 1 is a ball, where the cameras look at, that fills the photographs");
    command.add_number("--most-cost", o->cost, limits::dense_cost,
                       "1 less the correlation of patches, above which a pixel has no depth");
    command.add_number("--seed", o->seed, limits::seed, "of everything random");
    command.add_text("-o,--output", *out, "folder of the maps: `stereo` of a COLMAP workspace").required().idle();
    add_json(command, *json);
    add_force(command, o->force);
    command.writes([=] { return std::vector{OutputTarget{.path = *out}}; }, [=] { print_done(*out, *json); });
    command.on_run([=] { print_depths(compute_depths(*o, *out), *json); });
}

void add_cut_mesh(CommandLine& parent) {
    struct Options {
        std::string mesh, model, depths, images, masks, out;
        double region = 1.2;
        CutOptions cut;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command = parent.add_command("cut-mesh", "the part of a mesh that is the object");
    command.add_text("mesh", o->mesh, "PLY or OBJ in the model's frame").required().input();
    command.add_text("--model", o->model, model_help).required().input();
    command.add_text("--depths", o->depths, "folder that `capture depths` wrote").required().input();
    command.add_text("--images", o->images, "folder of the photographs; with --masks").input();
    command.add_text("--masks", o->masks, "folder of masks of the undistorted photographs, white = object").input();
    command.add_number("--region", o->region, limits::dense_region, "as of `capture depths`");
    command.add_number("--support", o->cut.support, limits::cut_support,
                       "photographs whose depths have to agree with the mesh");
    command.add_number("--close", o->cut.close, limits::cut_close,
                       "a hole is filled from whose middle it is so many triangles to its edge, or fewer");
    command.add_choice(
        "--ground", o->cut.ground, {{"cut", GroundRule::cut}, {"keep", GroundRule::keep}, {"disc", GroundRule::disc}},
        "the plane that the object stands on: cut off, kept, or a disc of it around the object; default: cut");
    command.add_text("-o,--output", o->out, "PLY").required().idle();
    command.writes([=] { return std::vector{OutputTarget{.path = o->out}}; });
    command.on_run([=] {
        require_ending(o->out, ".ply");
        require_images(o->images, o->masks);
        const Calibration model = read_colmap(o->model);
        const Mesh mesh = read_mesh_file(o->mesh).mesh;
        const auto files = find_mask_files(model, o->images, o->masks);
        const std::vector<PlaneMap> maps = read_planes(o->depths, model);
        std::vector<Camera> cameras;
        std::vector<std::vector<uint8_t>> masks(maps.size());
        for (const CalibratedImage& image : model.images) cameras.push_back(image.camera);
        parallel_for(maps.size(), 1, [&](size_t i, int) { masks[i] = load_mask(files, i, cameras[i]); });
        CutReport report;
        const Mesh cut = cut_mesh(mesh, maps, masks, region_of(cameras, o->region), o->cut, report);
        write_ply(cut, o->out, made_by_remark());
        fmt::print(
            "{} triangles of {} vertices; of the mesh's {} are left out: {} far away, {} outside the masks, {} in "
            "front of what photographs see, {} that no depths support, {} apart\n",
            cut.triangle_count(), cut.vertex_count(), report.vertices, report.off_region, report.off_masks,
            report.in_free_space, report.unsupported, report.apart);
        if (!report.ground && o->cut.ground != GroundRule::keep) fmt::print("no plane that it stands on was found\n");
        if (report.ground)
            fmt::print("{}; --ground keep leaves all of it\n", o->cut.ground == GroundRule::cut
                                                                   ? "the plane that it stands on is cut off"
                                                                   : "of the plane that it stands on a disc is left");
    });
}

void add_masks(CommandLine& parent) {
    struct Options {
        std::string mesh, model, out;
        int inset = 2;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command = parent.add_command("masks", "masks of photographs from what their cameras see of a mesh");
    command.add_text("mesh", o->mesh, "PLY or OBJ in the model's frame").required().input();
    command.add_text("--model", o->model, "folder of a COLMAP model of undistorted photographs").required().input();
    command.add_number("--inset", o->inset, limits::mask_inset, "pixels that are left out along the outline");
    command.add_text("-o,--output", o->out, "folder of the masks").required().idle();
    command.writes([=] { return std::vector{OutputTarget{.path = o->out}}; });
    command.on_run([=] { write_mesh_masks(read_mesh_file(o->mesh).mesh, read_colmap(o->model), o->inset, o->out); });
}

void print_mesh(const MeshCheck& check, bool masked, bool json) {
    if (!json) {
        fmt::print(
            "{} triangles; {} views of points, {:.3f} % of the diagonal from the mesh in the median, {:.0f} % of "
            "them within 1 %\nthe mesh covers {:.1f} % of the photographs in the median",
            check.triangles, check.points, 100 * check.distance, 100 * check.near_share, 100 * check.share);
        if (masked) fmt::print("; mesh and masks agree on {:.0f} % of what either has", 100 * check.overlap);
        fmt::print("\n{} {}; {} {}, together {:.2f} times the diagonal long\n", check.pieces,
                   check.pieces == 1 ? "piece" : "pieces", check.borders, check.borders == 1 ? "border" : "borders",
                   check.border_length);
        if (check.surface)
            fmt::print(
                "by the photographs' depths {:.1f} % of its area is where they are, {:.2f} % in front of what "
                "photographs see, and of {:.1f} % nothing is known\n",
                100 * check.surface->supported, 100 * check.surface->in_free_space, 100 * check.surface->unknown);
        return;
    }
    Json photographs = Json::array();
    for (const MeshCheck::Photograph& p : check.photographs) {
        photographs.push_back({{"name", p.name}, {"share", p.share}});
        if (masked) photographs.back()["overlap"] = p.overlap;
    }
    Json all = {{"vertices", check.vertices},
                {"triangles", check.triangles},
                {"point_views", check.points},
                {"median_distance", check.distance},
                {"near_share", check.near_share},
                {"share", check.share},
                {"pieces", check.pieces},
                {"borders", check.borders},
                {"border_length", check.border_length},
                {"poor", check.poor},
                {"photographs", photographs}};
    if (check.surface)
        all["surface"] = {{"supported", check.surface->supported},
                          {"in_free_space", check.surface->in_free_space},
                          {"unknown", check.surface->unknown}};
    if (masked) all["overlap"] = check.overlap;
    fmt::print("{}\n", all.dump(2));
}

void add_check_mesh(CommandLine& parent) {
    struct Options {
        std::string mesh, model, depths, images, masks;
        bool json = false, go_on = false;
    };
    auto o = std::make_shared<Options>();
    CommandLine& command =
        parent.add_command("check-mesh", "whether a mesh is where the calibration's points, depths and masks are");
    command.add_text("mesh", o->mesh, "PLY or OBJ in the model's frame").required();
    command.add_text("--model", o->model, model_help).required();
    command.add_text("--depths", o->depths,
                     "folder that `capture depths` wrote: tells flaps in front of what photographs see");
    command.add_text("--images", o->images, "folder of the photographs; with --masks");
    command.add_text("--masks", o->masks, "folder of masks of the undistorted photographs, white = object");
    command.add_flag("--go-on", o->go_on, "only warn of what is poor");
    add_json(command, o->json);
    command.on_run([=] {
        require_images(o->images, o->masks);
        const MeshCheck check = check_mesh(
            {.mesh = o->mesh, .model = o->model, .depths = o->depths, .images = o->images, .masks = o->masks});
        judge(check.poor, o->go_on);
        print_mesh(check, !o->masks.empty(), o->json);
    });
}

void add_preview(CommandLine& parent) {
    auto o = std::make_shared<PreviewInput>();
    auto out = std::make_shared<std::string>();
    CommandLine& command = parent.add_command(
        "preview", "a picture of three photographs above what is known of the object: points, or a mesh");
    command.add_text("--model", o->model, model_help).required().input();
    command.add_text("--images", o->images, "folder of the undistorted photographs").required().input();
    command.add_text("--mesh", o->mesh, "PLY or OBJ in the model's frame; else the model's points are drawn").input();
    command.add_text("-o,--output", *out, "PNG").required().idle();
    command.writes([=] { return std::vector{OutputTarget{.path = *out}}; });
    command.on_run([=] {
        require_ending(*out, ".png");
        write_preview(*o, *out);
    });
}

}  // namespace

void add_capture(CommandLine& program) {
    CommandLine& command = program.add_command("capture", "steps from photographs to a mesh, and how good each is");
    for (const auto add : {add_check_model, add_depths, add_cut_mesh, add_masks, add_check_mesh, add_preview})
        add(command);
}

}  // namespace radiafit::tools
