// generate, info, plan: everything about a dataset before it is fitted.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/json.h"
#include "base/leftovers.h"
#include "base/log.h"
#include "base/printable.h"
#include "base/read_file.h"
#include "base/resources.h"
#include "capture/capture_check.h"
#include "capture/small_view.h"
#include "cli/commands.h"
#include "dataset/checksums.h"
#include "dataset/truth.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/limits.h"
#include "fitting/parts/parts.h"
#include "fitting/resolve_options.h"
#include "report/table.h"
#include "synthetic/synthetic.h"

namespace radiafit::tools {
namespace {

/// "solving, writing"; "" of what is held all along.
std::string stages_of(const PlanRow& row) {
    if (row.stages == PlanRow::while_all) return "";
    std::string names;
    for (const auto& [stage, name] : {std::pair{PlanRow::while_distributing, "distributing"},
                                      {PlanRow::while_learning, "learning"},
                                      {PlanRow::while_solving, "solving"},
                                      {PlanRow::while_writing, "writing"}})
        if (row.stages & stage) names += names.empty() ? name : std::string(", ") + name;
    return names;
}

using Json = nlohmann::ordered_json;

void print_rows(const char* title, const std::vector<PlanRow>& rows) {
    const bool staged = std::ranges::any_of(rows, [](const PlanRow& r) { return r.stages != PlanRow::while_all; });
    Table table(staged ? std::vector<std::string>{"array", "shape", "count", "MB", "while"}
                       : std::vector<std::string>{"array", "shape", "count", "MB"});
    const auto add = [&](std::vector<std::string> cells, const std::string& stages) {
        if (staged) cells.push_back(stages);
        table.add(cells);
    };
    for (const PlanRow& r : rows)
        add({r.array, r.shape, std::to_string(r.count), fmt::format("{:.2f}", double(r.bytes) / 1e6)}, stages_of(r));
    add({staged ? "most at a time" : "total", "", "", fmt::format("{:.2f}", double(total_bytes(rows)) / 1e6)}, "");
    fmt::print("{}\n{}\n", title, table.text());
}

void print_plan(const std::string& chosen, const Plan& planned, const std::optional<PlannedSeconds>& seconds,
                const std::optional<PartNeeds>& parts) {
    if (!chosen.empty()) fmt::print("{}\n\n", chosen);
    print_rows("this program", planned.memory);
    if (seconds)
        fmt::print("seconds on this machine, by a few images and vertices: distributing {:.3g}, solving {:.3g}\n\n",
                   seconds->distributing, seconds->solving);
    print_rows("on disk", planned.disk);
    if (parts) {
        const std::string learning =
            parts->learning ? readable_bytes(parts->learning) + " while learning, " : std::string();
        fmt::print("in {} parts, {} of memory at most ({}{} for a part, {} to put them together) and {} of disk\n",
                   parts->parts, readable_bytes(parts->memory), learning, readable_bytes(parts->part),
                   readable_bytes(parts->merging), readable_bytes(parts->disk));
    }
    if (!planned.paper.empty()) print_rows("paper layout (Section 6.3; the accounting is ours)", planned.paper);
}

void print_plan_json(const Plan& planned, const std::optional<PlannedSeconds>& seconds,
                     const std::optional<PartNeeds>& parts) {
    const auto rows_of = [](const std::vector<PlanRow>& rows) {
        Json out = Json::array();
        for (const PlanRow& r : rows)
            out.push_back({{"array", r.array}, {"shape", r.shape}, {"count", r.count}, {"bytes", r.bytes}});
        return Json{{"most_bytes", total_bytes(rows)}, {"arrays", out}};
    };
    Json json = {{"memory", rows_of(planned.memory)}, {"disk", rows_of(planned.disk)}};
    if (seconds) json["seconds"] = {{"distributing", seconds->distributing}, {"solving", seconds->solving}};
    if (parts) json["parts"] = {{"count", parts->parts}, {"memory_bytes", parts->memory}, {"disk_bytes", parts->disk}};
    if (!planned.paper.empty()) json["paper_layout"] = rows_of(planned.paper);
    fmt::print("{}\n", json.dump(2));
}

void print_fit(Fitted& fit, bool json) {
    const FitRecord& f = fit.record();
    const auto counts = f.status_counts();
    if (json) {
        Json status = Json::object();
        for (size_t s = 0; s < counts.size(); ++s) status[to_string(Status(s))] = counts[s];
        const Json object = {{"kind", "fit"},
                             {"dataset", f.dataset_name},
                             {"solver", f.solver},
                             {"engine", f.engine},
                             {"problems", f.problem_count()},
                             {"status", status},
                             {"options", Json::parse(f.options_json.empty() ? "{}" : f.options_json)}};
        fmt::print("{}\n", object.dump(2));
        return;
    }
    fmt::print("fit of {} by {} on {}: {}\n", printable(f.dataset_name), printable(f.solver), printable(f.engine),
               description_of(fit));
    for (size_t s = 0; s < counts.size(); ++s)
        if (counts[s]) fmt::print("{:>16}  {} problems: {}\n", to_string(Status(s)), counts[s], meaning(Status(s)));
}

}  // namespace

void add_force(CommandLine& command, bool& force) {
    command.add_flag("--force", force, "go on though memory or disk will not suffice").idle();
}

void require_ending(const std::filesystem::path& file, const std::string& ending) {
    if (file.extension() != ending)
        throw UserError(fmt::format("{}: name a file that ends in {}", file.string(), ending));
}

void print_done(const std::string& output, bool json) {
    if (json) fmt::print("{}\n", json_text(Json{{"done_already", output}}, 2, NotUtf8::replace));
}

void add_json(CommandLine& command, bool& json) {
    command
        .add_switch(
            "--json",
            [&json] {
                json = true;
                set_quiet(true);
            },
            "one JSON object on standard output")
        .idle();
}

OutputTarget dataset_target(const std::filesystem::path& folder) {
    return {.path = folder, .check = [folder] { check_dataset_target(folder); }};
}

void print_dataset(const Dataset& d, bool json) {
    const size_t held_out = d.split(true).size();
    double least = 1e300, most = 0;
    for (const View& v : d.views) least = std::min(least, v.gain.least()), most = std::max(most, v.gain.most());
    const MeshDefects defects = find_defects(d.mesh);
    const char* light = !d.light_moves() ? "fixed" : d.views[0].light->kind == Light::Kind::near ? "near" : "distant";
    const bool truth = has_truth(d);
    const Grid& grid = d.grid;
    const size_t usable =
        grid.texel_count() - size_t(std::count(grid.texel_normals.begin(), grid.texel_normals.end(), Vec3f::Zero()));
    if (json) {
        Json object = {{"kind", "dataset"},
                       {"name", d.name},
                       {"description", d.description},
                       {"source", d.source},
                       {"checksum", dataset_checksum(d)},
                       {"encoding", to_string(d.encoding)},
                       {"triangles", d.mesh.triangle_count()},
                       {"vertices", d.mesh.vertex_count()},
                       {"degenerate_triangles", defects.degenerate_triangles.size()},
                       {"unreferenced_vertices", defects.unreferenced_vertices.size()},
                       {"views", d.views.size()},
                       {"held_out", held_out},
                       {"image_bytes", d.image_bytes()},
                       {"light", light},
                       {"normals_side", d.normal_map.side},
                       {"truth", truth}};
        if (d.has_grid()) object["grid"] = {{"width", grid.width}, {"height", grid.height}, {"usable", usable}};
        fmt::print("{}\n", object.dump(2));
        return;
    }
    fmt::print("dataset {}: {}\n{}\n", printable(d.name), printable(d.description), printable(d.source));
    if (d.has_grid())
        fmt::print("grid of {} x {} texels, {} of them usable; normals {}\n", grid.width, grid.height, usable,
                   grid.texel_normals.empty() ? "of the plane" : "per texel");
    else
        fmt::print("{} triangles ({} degenerate), {} vertices ({} unreferenced)\n", d.mesh.triangle_count(),
                   defects.degenerate_triangles.size(), d.mesh.vertex_count(), defects.unreferenced_vertices.size());
    fmt::print("{} views, {} of them held out; {} of {}, {:.1f} MB raw; gains {:.3f} to {:.3f}\n", d.views.size(),
               held_out, to_string(d.encoding),
               d.views.empty() ? "" : fmt::format("{}x{} and alike", d.views[0].camera.width, d.views[0].camera.height),
               double(d.image_bytes()) / 1e6, least, most);
    if (d.light_moves()) fmt::print("one {} lamp per image\n", light);
    if (d.normal_map.side > 0)
        fmt::print("normals of {} texels, surface side {}; truth: {}\n", d.normal_map.normals.size(), d.normal_map.side,
                   truth ? "yes" : "no");
}

void add_generate(CommandLine& program) {
    auto options = std::make_shared<SyntheticOptions>();
    auto out = std::make_shared<std::string>();
    auto force = std::make_shared<bool>(false);
    auto json = std::make_shared<bool>(false);
    CommandLine& command =
        program.add_command("generate", "make a synthetic dataset (a stand-in for one of the paper's)");
    command.add_word("shape", options->shape, "star, bust or ornament")
        .choices({"star", "bust", "ornament"})
        .hide_default()
        .required();
    command.add_word("--scale", options->scale, "smoke, standard or paper").choices({"smoke", "standard", "paper"});
    command.add_number("--seed", options->seed, limits::seed, "of everything random");
    command.add_number("--subdivide", options->subdivide, limits::subdivide,
                       "star and bust: each triangle in so many times so many equal ones, of the same photographs");
    OrnamentOptions& ornament = options->ornament;
    std::vector<CommandOption> of_ornament = {
        command.add_choice("--encoding", ornament.sensor.encoding,
                           {{"u8-srgb", Encoding::u8_srgb},
                            {"u16-linear", Encoding::u16_linear},
                            {"f32-linear", Encoding::f32_linear}},
                           "how pixels are stored (u16-linear unless given)"),
        command.add_number("--read-noise", ornament.sensor.read_noise, limits::noise,
                           "standard deviation of darkness; white is 1"),
        command.add_number("--shot-noise", ornament.sensor.shot_noise, limits::noise,
                           "standard deviation that white adds"),
        command.add_choice(
            "--shading", ornament.shading, {{"texel", Shading::texel}, {"pixel", Shading::pixel}},
            "texel: samples hold their texel's exact value (unless given); pixel: pixels average over their area"),
        command.add_choice("--light", ornament.light, {{"distant", Light::Kind::distant}, {"near", Light::Kind::near}},
                           "the lamp's kind (distant unless given); near: falls off with the distance squared"),
    };
    for (CommandOption& option : of_ornament) option.group("ornament");
    command.add_text("-o,--output", *out, "folder of the packed dataset").required().idle();
    add_force(command, *force);
    add_json(command, *json);
    command.writes([=] { return std::vector{dataset_target(*out)}; },
                   [=] { print_dataset(open_dataset(*out), *json); });
    command.on_run([=] {
        announce_needs("generate", synthetic_needs(*options), *out, *force);
        generate_synthetic(*options, *out);
        print_dataset(open_dataset(*out), *json);
    });
}

/// Says whether cameras, photographs and mesh belong together.
void check_parts(const Dataset& dataset, const std::string& name) {
    if (dataset.light_moves())
        throw UserError(fmt::format(
            "--check: the lamps of {} move, so that its images differ by themselves: leave --check out", name));
    if (dataset.has_grid())
        throw UserError(
            fmt::format("--check: {} is a grid, whose images show it pixel on pixel: leave --check out", name));
    const CaptureCheck check = check_capture(dataset.mesh, small_views(dataset, most_checked_views));
    log_info(fmt::format("{} photographs; {}", dataset.views.size(), check.summary));
    if (check.masks_inverted) log_warning("the mesh shows where the masks are black: import again with --invert-masks");
    if (const auto& found = check.misplacement)
        log_warning(fmt::format(
            "colours correlate by {:.2f} between neighbours; {} by {:.2f}: the mesh or the cameras are "
            "not as they should be ({}): import again{}",
            found->given.colours.correlation(), found->what, found->tried.colours.correlation(), found->why,
            found->cure.empty() ? " with " + describe_placement(found->move) + ", after what placed the mesh before"
                                : ": " + found->cure));
    for (const std::string& note : check.notes) log_warning(note);
}

void add_info(CommandLine& program) {
    auto folder = std::make_shared<std::string>();
    auto moved_to = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false), check = std::make_shared<bool>(false);
    CommandLine& command = program.add_command("info", "what a dataset or fit is, checked whole");
    command.add_text("folder", *folder, "DATASET or FIT").required();
    command.add_text("--dataset", *moved_to, "where a fit's dataset is now, if it moved");
    command.add_flag(
        "--check", *check,
        "compare what neighbouring photographs show at the same places of a dataset's mesh, and say what is wrong");
    add_json(command, *json);
    command.on_run([=] {
        const std::filesystem::path path(*folder);
        restore_interrupted(path);
        const bool is_folder = folder_exists(path), fit = is_folder && path_exists(path / "fit.json");
        if (is_folder && !fit && !path_exists(path / "dataset.json"))
            throw UserError(
                fmt::format("{}: neither a dataset nor a fit: it holds no dataset.json and no fit.json; give a folder "
                            "that radiafit generate, import or fit wrote",
                            path.string()));
        if (!fit && !moved_to->empty())
            throw UserError(fmt::format("--dataset {}: {} is no fit; leave it out", *moved_to, path.string()));
        if (fit && *check)
            throw UserError(fmt::format("--check: {} is a fit: give the dataset that it was fitted to", path.string()));
        if (fit) {
            Fitted fitted = open_fit(path, *moved_to);
            return print_fit(fitted, *json);
        }
        const Dataset dataset = open_dataset(path);
        check_pixels(dataset);
        if (*check) check_parts(dataset, path.string());
        print_dataset(dataset, *json);
    });
}

void add_plan(CommandLine& program) {
    auto request = std::make_shared<FitRequest>();
    auto folder = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    CommandLine& command = program.add_command("plan", "bytes of each array before anything is allocated");
    command.add_text("dataset", *folder, "packed dataset").required();
    add_fit_options(command, *request);
    add_json(command, *json);
    command.on_run([=, &command] {
        const Dataset dataset = open_dataset(*folder);
        const auto given = [&](const char* option) { return command.given(option); };
        const std::string chosen = resolve_options(given, dataset, *request);
        reject_idle_options(*request, dataset.has_grid());
        const Plan planned = plan(dataset, *request);
        const auto seconds = plan_seconds(dataset, *request);
        std::optional<PartNeeds> parts;
        if (needs_parts(dataset, *request)) {
            const auto whole = family_of(*request).divide(dataset, *request);
            parts = count_parts(*whole, {}, *request);
        }
        if (*json)
            print_plan_json(planned, seconds, parts);
        else
            print_plan(chosen, planned, seconds, parts);
    });
}

}  // namespace radiafit::tools
