#include "fit/fit_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/leftovers.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "dataset/mesh_ply.h"
#include "fit/error_bar_maps.h"
#include "fit/fit_json.h"
#include "fit/fit_maps.h"
#include "fit/folder_parts.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

constexpr const char* sides_name = "sides.exr";

std::string surface_name(int term, int corner) { return fmt::format("surface_term{}_corner{}.exr", term, corner); }
std::string view_name(int term) { return fmt::format("view_term{}.exr", term); }

// A fit's two halves, the images and the vector of parameters, meet over the same geometry.
struct Shape {
    TriangleAtlas atlas;
    VertexRings rings;
    LfmLayout layout;
    Shape(const Mesh& mesh, const LfmOptions& o)
        : atlas(surface_atlas(mesh, o)), rings(mesh), layout(rings, atlas, o.view_side, o.terms) {}
};

/// Side by side, unless they are so large that memory counts for more than time.
void write_maps(const fs::path& folder, const std::string& prefix, const Shape& shape, std::span<const float> numbers) {
    const size_t maps = size_t(shape.layout.terms()) * 4;
    parallel_for(maps, written_side_by_side(shape.atlas, shape.layout) ? 1 : maps, [&](size_t job, int) {
        const int term = int(job / 4), corner = int(job % 4);
        if (corner < 3)
            write_exr(folder / (prefix + surface_name(term, corner)),
                      surface_image(shape.atlas, shape.layout, numbers, term, corner));
        else
            write_exr(folder / (prefix + view_name(term)), view_image(shape.layout, numbers, term));
    });
}

}  // namespace

std::array<uint64_t, size_t(Status::count)> FitRecord::status_counts() const {
    std::array<uint64_t, size_t(Status::count)> counts{};
    for (const Status s : status) ++counts[size_t(s)];
    return counts;
}

void set_dataset(FitRecord& fit, const Dataset& dataset) {
    fit.dataset_path = dataset.folder;
    fit.dataset_name = dataset.name;
    fit.encoding = dataset.encoding;
    fit.dataset_fingerprint = fingerprint(dataset);
}

void check_fit_target(const fs::path& folder) {
    std::error_code error;
    if (!fs::exists(folder, error)) return;
    const auto refuse = [&](const std::string& why) {
        throw UserError(fmt::format("{}: {}; remove it or choose another name for the fit", folder.string(), why));
    };
    if (!fs::is_directory(folder, error)) refuse("a file is there");
    const std::vector<std::string> present = names_in(folder);
    if (present.empty()) return;
    const fs::path json = folder / fit_json_name;
    if (!fs::is_regular_file(json, error)) refuse("not a fit, it has no fit.json");
    // Only files that the fit lists may go: nobody's renders or notes with them.
    const std::vector<std::string> own = files_in_json(read_text(json));
    for (const std::string& name : present)
        if (std::find(own.begin(), own.end(), name) == own.end())
            refuse("holds " + name + ", which is no part of a fit");
}

void write_fit(const fs::path& folder, const LightFieldFit& fit, const Mesh& mesh,
               const std::function<void(const fs::path&)>& add_files) {
    check_options(fit.options);
    const Shape shape(mesh, fit.options);
    const size_t problems = 3 * mesh.vertex_count();
    require(fit.parameters.size() == shape.layout.size(), "as many parameters as the layout has");
    require_problems(fit, problems);

    check_fit_target(folder);
    AtomicFolder target(folder, AtomicFolder::Existing::replace);
    const fs::path& place = target.path();
    if (add_files) add_files(place);
    write_ply(mesh, place / "mesh.ply");
    write_exr(place / problems_name, problem_image(fit));
    if (fit.options.sides) write_exr(place / sides_name, side_image(*fit.options.sides));
    write_maps(place, "", shape, fit.parameters);
    std::vector<std::string> files = names_in(place);
    files.push_back(fit_json_name);
    write_file(place / fit_json_name, fit_to_json(fit, shape.atlas, dataset_from(target.target(), fit), files));
    target.commit();
}

void write_error_bars(const fs::path& folder, const LightFieldFit& fit, const Mesh& mesh, const ErrorBarMaps& bars) {
    write_maps(folder, "deviation_", Shape(mesh, fit.options), bars.deviation);
    write_exr(folder / error_bars_name, error_bar_image(bars));
}

bool has_error_bars(const fs::path& folder) {
    std::error_code error;
    return fs::is_regular_file(folder / error_bars_name, error);
}

std::string fitted_model(const fs::path& folder) {
    require_folder(folder);
    return model_in_json(folder / fit_json_name, read_text(folder / fit_json_name));
}

StoredFit read_fit(const fs::path& folder) {
    require_folder(folder);
    StoredFit stored;
    LightFieldFit& fit = stored.fit;
    const FitPromises promises = fit_from_json(folder / fit_json_name, read_text(folder / fit_json_name), fit);
    fit.dataset_path = (fs::absolute(folder) / promises.dataset_path).lexically_normal();

    const fs::path mesh_path = folder / "mesh.ply";
    stored.mesh = read_ply(mesh_path);
    if (stored.mesh.vertex_count() != fit.dataset_fingerprint.vertices ||
        stored.mesh.triangle_count() != fit.dataset_fingerprint.triangles)
        throw UserError(fmt::format("{}: {} vertices and {} triangles, but fit.json says {} and {}; fit again",
                                    mesh_path.string(), stored.mesh.vertex_count(), stored.mesh.triangle_count(),
                                    fit.dataset_fingerprint.vertices, fit.dataset_fingerprint.triangles));
    if (!promises.sides.empty()) {
        const fs::path path = folder / sides_name;
        fit.options.sides = read_sides(path, stored.mesh.triangle_count(), fit.options.surface_side);
        if (checksum_of(*fit.options.sides) != promises.sides)
            throw UserError(path.string() + ": not as fit.json describes it; restore it or fit again");
    }
    const Shape shape(stored.mesh, fit.options);
    const fs::path problems = folder / problems_name;
    take_problem_image(problems, stored.mesh.vertex_count(), fit);
    check_promises(fit, promises, problems);
    fit.parameters.assign(shape.layout.size(), 0.0f);
    parallel_for(size_t(fit.options.terms) * 4, 1, [&](size_t job, int) {
        const int term = int(job / 4), corner = int(job % 4);
        if (corner < 3)
            take_surface_image(folder / surface_name(term, corner), shape.atlas, shape.layout, term, corner, fit);
        else
            take_view_image(folder / view_name(term), shape.layout, term, fit);
    });
    return stored;
}

Dataset open_fitted_dataset(const FitRecord& fit, const fs::path& moved_to) {
    const fs::path path = moved_to.empty() ? fit.dataset_path : moved_to;
    if (!path_exists(path))
        throw UserError(
            fmt::format("{}: the dataset of this fit ({}) is no longer there; move it back or name its folder{}",
                        path.string(), fit.dataset_name, at_command_line(" by --dataset", "")));
    Dataset dataset = open_dataset(path);
    if (fingerprint(dataset) != fit.dataset_fingerprint)
        throw UserError(fmt::format(
            "{}: differs from the dataset that was fitted ({}: {} views, {} triangles); fit "
            "again or name the right folder",
            path.string(), fit.dataset_name, fit.dataset_fingerprint.views, fit.dataset_fingerprint.triangles));
    return dataset;
}

}  // namespace radiafit
