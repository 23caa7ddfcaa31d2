#include "fit/fit_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/leftovers.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "dataset/mesh_ply.h"
#include "fit/fit_json.h"
#include "fit/fit_maps.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

constexpr const char* problems_name = "problems.exr";
constexpr const char* sides_name = "sides.exr";

std::string surface_name(int term, int corner) { return fmt::format("surface_term{}_corner{}.exr", term, corner); }
std::string view_name(int term) { return fmt::format("view_term{}.exr", term); }

std::string read_text(const fs::path& path) {
    std::error_code ignored;
    if (fs::symlink_status(path, ignored).type() == fs::file_type::not_found)
        throw UserError(fmt::format("{}: no such file; {}", path.string(),
                                    at_command_line("give a folder that radiafit fit wrote", "give a fit's folder")));
    return read_file(path, "fit's description");
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

void require(bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("write_fit: " + what);
}

void require_problems(const FitRecord& fit, size_t problems) {
    require(fit.status.size() == problems && fit.iterations.size() == problems && fit.samples.size() == problems &&
                fit.error.size() == problems,
            "status, iterations, samples and error per problem");
    for (const uint32_t samples : fit.samples) require(samples <= 1u << 24, "samples per problem up to 2^24");
}

void require_folder(const fs::path& folder) {
    restore_interrupted(folder);
    if (!folder_stands(folder))
        throw UserError(fmt::format("{}: no such folder; {}", folder.string(),
                                    at_command_line("radiafit fit writes one", "give a fit's folder")));
}

void check_promises(const FitRecord& fit, const FitPromises& promises, const fs::path& problems) {
    if (fit.status_counts() != promises.status_counts)
        throw UserError(
            fmt::format("{}: its statuses disagree with those counted in fit.json; restore the file or fit again",
                        problems.string()));
}

// Relative, so that a fit and its dataset can move together; absolute where there is no relative way.
std::string dataset_from(const fs::path& folder, const FitRecord& fit) {
    std::error_code error;
    fs::path dataset = fs::relative(fit.dataset_path, fs::absolute(folder), error);
    if (error || dataset.empty()) dataset = fs::absolute(fit.dataset_path);
    return dataset.generic_string();
}

/// The parameter maps of a texel-local model: its coefficients, and -1 for a shape.
std::vector<int> maps_of(const TexelModel& model) {
    std::vector<int> out;
    for (int k = 0; k < model.basis; ++k) out.push_back(k);
    if (model.shape > 0) out.push_back(-1);
    return out;
}

// A fit's two halves, the images and the vector of parameters, meet over the same geometry.
struct Shape {
    TriangleAtlas atlas;
    VertexRings rings;
    LfmLayout layout;
    Shape(const Mesh& mesh, const LfmOptions& o)
        : atlas(surface_atlas(mesh, o)), rings(mesh), layout(rings, atlas, o.view_side, o.terms) {}
};

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
    if (!fs::is_directory(folder, error)) refuse("a file stands there");
    const std::vector<std::string> present = names_in(folder);
    if (present.empty()) return;
    const fs::path json = folder / fit_json_name;
    if (!fs::is_regular_file(json, error)) refuse("not a fit, it has no fit.json");
    // Only what a fit listed as its own may go: nobody's renders or notes with it.
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
    // Side by side, unless they are so large that memory counts for more than time.
    const size_t maps = size_t(fit.options.terms) * 4;
    parallel_for(maps, written_side_by_side(shape.atlas, shape.layout) ? 1 : maps, [&](size_t job, int) {
        const int term = int(job / 4), corner = int(job % 4);
        if (corner < 3)
            write_exr(place / surface_name(term, corner), surface_image(shape.atlas, shape.layout, fit, term, corner));
        else
            write_exr(place / view_name(term), view_image(shape.layout, fit, term));
    });
    std::vector<std::string> files = names_in(place);
    files.push_back(fit_json_name);
    write_file(place / fit_json_name, fit_to_json(fit, shape.atlas, dataset_from(target.target(), fit), files));
    target.commit();
}

void write_fit(const fs::path& folder, const ReflectanceFit& fit, const Atlas& atlas,
               const std::function<void(const fs::path&)>& add_files) {
    check_options(fit.options);
    const TexelModel& model = *fit.options.model;
    const size_t problems = atlas.texel_count();
    require(fit.parameters.size() == problems * size_t(model.parameters), "as many parameters as texels have");
    require_problems(fit, problems);

    check_fit_target(folder);
    AtomicFolder target(folder, AtomicFolder::Existing::replace);
    const fs::path& place = target.path();
    if (add_files) add_files(place);
    write_exr(place / problems_name, problem_image(atlas, fit));
    for (const int k : maps_of(model)) write_exr(place / parameter_map_name(model, k), parameter_image(atlas, fit, k));
    std::vector<std::string> files = names_in(place);
    files.push_back(fit_json_name);
    write_file(place / fit_json_name, fit_to_json(fit, atlas, dataset_from(target.target(), fit), files));
    target.commit();
}

std::string fitted_model(const fs::path& folder) {
    require_folder(folder);
    return model_in_json(folder / fit_json_name, read_text(folder / fit_json_name));
}

StoredReflectance read_reflectance(const fs::path& folder, const fs::path& moved_to) {
    require_folder(folder);
    StoredReflectance stored;
    ReflectanceFit& fit = stored.fit;
    const FitPromises promises = fit_from_json(folder / fit_json_name, read_text(folder / fit_json_name), fit);
    fit.dataset_path = (fs::absolute(folder) / promises.dataset_path).lexically_normal();
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    stored.atlas = texel_atlas(*stored.dataset, fit.options.surface_side);
    const TexelModel& model = *fit.options.model;
    fit.parameters.assign(size_t(stored.atlas->texel_count()) * size_t(model.parameters), 0.0f);
    for (const int k : maps_of(model))
        take_parameter_image(folder / parameter_map_name(model, k), *stored.atlas, k, fit);
    const fs::path problems = folder / problems_name;
    take_problem_image(problems, *stored.atlas, fit);
    check_promises(fit, promises, problems);
    return stored;
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
    if (!stands(path))
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
