#include "fit/texel_fit.h"

#include "base/atomic_file.h"
#include "base/file.h"
#include "fit/error_bar_maps.h"
#include "fit/fit_maps.h"
#include "fit/folder_parts.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

size_t numbers_of(std::span<const TexelMap> maps) {
    size_t numbers = 0;
    for (const TexelMap& map : maps) numbers += map.channels.size();
    return numbers;
}

}  // namespace

void write_texel_fit(const fs::path& folder, const FitRecord& fit, const TexelFitNotes& notes, const Atlas& atlas,
                     std::span<const TexelMap> maps, std::span<const float> parameters,
                     const std::function<void(const fs::path&)>& add_files) {
    require(parameters.size() == atlas.texel_count() * numbers_of(maps), "as many parameters as texels have");
    require_problems(fit, atlas.texel_count());

    check_fit_target(folder);
    AtomicFolder target(folder, AtomicFolder::Existing::replace);
    const fs::path& place = target.path();
    if (add_files) add_files(place);
    write_exr(place / problems_name, problem_image(atlas, fit));
    for (const TexelMap& map : maps) write_exr(place / map.file, parameter_image(atlas, parameters, map));
    std::vector<std::string> files = names_in(place);
    files.push_back(fit_json_name);
    write_file(place / fit_json_name, fit_to_json(fit, notes, atlas, dataset_from(target.target(), fit), files));
    target.commit();
}

void write_error_bars(const fs::path& folder, const Atlas& atlas, std::span<const TexelMap> maps,
                      const ErrorBarMaps& bars) {
    for (const TexelMap& map : maps)
        write_exr(folder / ("deviation_" + map.file), parameter_image(atlas, bars.deviation, map));
    std::vector<float> both;
    for (size_t t = 0; t < bars.noise.size(); ++t) both.insert(both.end(), {bars.noise[t], float(bars.deficient[t])});
    write_exr(folder / error_bars_name, parameter_image(atlas, both, {error_bars_name, {"noise", "deficient"}, 0}));
}

TexelFitReader::TexelFitReader(const fs::path& folder, const std::string& key, const TakeNotes& take, FitRecord& fit)
    : folder_(folder), fit_(&fit) {
    require_folder(folder);
    const fs::path json = folder / fit_json_name;
    const FitPromises promises = fit_from_json(json, read_text(json), key, take, fit);
    status_counts_ = promises.status_counts;
    fit.dataset_path = (fs::absolute(folder) / promises.dataset_path).lexically_normal();
}

std::vector<float> TexelFitReader::maps(const Atlas& atlas, std::span<const TexelMap> maps) {
    std::vector<float> parameters(atlas.texel_count() * numbers_of(maps));
    for (const TexelMap& map : maps) take_parameter_image(folder_, atlas, map, parameters);
    take_problem_image(folder_ / problems_name, atlas, *fit_);
    check_promises(*fit_, {.dataset_path = {}, .status_counts = status_counts_, .sides = {}}, folder_ / problems_name);
    return parameters;
}

void write_fit(const fs::path& folder, const ReflectanceFit& fit, const Atlas& atlas,
               const std::function<void(const fs::path&)>& add_files) {
    check_options(fit.options);
    write_texel_fit(folder, fit, notes_of(fit), atlas, maps_of(*fit.options.model), fit.parameters, add_files);
}

StoredReflectance read_reflectance(const fs::path& folder, const fs::path& moved_to) {
    StoredReflectance stored;
    ReflectanceFit& fit = stored.fit;
    TexelFitReader reader(
        folder, reflectance_key, [&](const auto& model, const auto& own) { take_notes(model, own, fit); }, fit);
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    stored.atlas = texel_atlas(*stored.dataset, fit.options.surface_side);
    fit.parameters = reader.maps(*stored.atlas, maps_of(*fit.options.model));
    return stored;
}

}  // namespace radiafit
