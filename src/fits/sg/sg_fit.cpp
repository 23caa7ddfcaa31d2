#include "sg/sg_fit.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/error.h"
#include "base/json.h"
#include "fit/texel_fit.h"
#include "model/texel_local.h"
#include "sg/sg_text.h"
#include "viewbasis/texel_contestant.h"

namespace radiafit::fits {
namespace {

using Json = nlohmann::ordered_json;

TexelFitNotes notes_of(const SgFit& fit) {
    const Json own = {{"surface_side", fit.surface_side}, {"lobes", fit.lobes}, {"up", numbers_of(fit.up)}};
    return {sg_name, sg_name, json_text(own)};
}

void take_notes(const std::string& model, const std::string& own_json, SgFit& fit) {
    if (model != sg_name) throw std::runtime_error("its model is not of spherical Gaussians");
    const Json own = parse_json<Json>(own_json);
    fit.surface_side = own.at("surface_side").get<int>();
    fit.lobes = own.at("lobes").get<int>();
    check_options(SgOptions{.lobes = fit.lobes});
    fit.up = vector_of(own.at("up"));
}

template <int lobes>
Contestant contestant_with(const SgFit& fit, const TriangleAtlas& atlas) {
    using Text = texel_text::SphericalGaussians<float, lobes>;
    using Model = TexelLocal<Text>;
    return texel_contestant(atlas, fit.surface, fit.space, [&fit, &atlas](uint32_t texel, const Vec3f& eye) {
        const Frame frame = view_frame(atlas.normal(texel), fit.up);
        const Vec3f v = view_direction(frame, atlas.position(texel), eye);
        typename Model::Parameters p;
        std::copy_n(&fit.parameters[size_t(texel) * p.size()], p.size(), p.begin());
        const auto value = Model::value(p, {{v.x(), v.y(), v.z()}});
        return Vec3f(value[0], value[1], value[2]);
    });
}

}  // namespace

std::vector<TexelMap> sg_maps(int lobes) {
    std::vector<TexelMap> maps{{"diffuse.exr", {"R", "G", "B"}, 0}};
    for (int l = 1; l <= lobes; ++l) maps.push_back({fmt::format("lobe{}.exr", l), {"R", "G", "B"}, 3 * size_t(l)});
    for (int l = 1; l <= lobes; ++l)
        maps.push_back({fmt::format("lobe{}_shape.exr", l), {"x", "y", "log_lambda"}, 3 * size_t(lobes + l)});
    return maps;
}

void write_fit(const std::filesystem::path& folder, const SgFit& fit, const TriangleAtlas& atlas,
               const std::function<void(const std::filesystem::path&)>& add_files) {
    write_texel_fit(folder, fit, notes_of(fit), atlas, sg_maps(fit.lobes), fit.parameters, add_files);
}

StoredSg read_sg(const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
    StoredSg stored;
    SgFit& fit = stored.fit;
    TexelFitReader reader(
        folder, sg_name, [&](const auto& model, const auto& own) { take_notes(model, own, fit); }, fit);
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    if (stored.dataset->mesh.triangles.empty()) throw UserError(folder.string() + ": its dataset has no mesh");
    stored.atlas = std::make_unique<TriangleAtlas>(stored.dataset->mesh, fit.surface_side);
    fit.parameters = reader.maps(*stored.atlas, sg_maps(fit.lobes));
    return stored;
}

Contestant contestant_of(const SgFit& fit, const TriangleAtlas& atlas) {
    constexpr decltype(&contestant_with<1>) of[] = {contestant_with<1>, contestant_with<2>, contestant_with<3>,
                                                    contestant_with<4>};
    return of[fit.lobes - 1](fit, atlas);
}

}  // namespace radiafit::fits
