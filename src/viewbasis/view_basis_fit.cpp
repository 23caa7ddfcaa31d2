#include "viewbasis/view_basis_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/error.h"
#include "fit/exr.h"
#include "fit/texel_fit.h"

namespace radiafit {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* basis_name = "basis.exr";

/// Block after block, 28 rows each: the means of the three channels, then the functions.
ExrImage basis_image(const ViewBasis& basis) {
    ExrImage image{3 + basis.rank, view_terms * int(basis.blocks.size()), {"coefficient"}, {}, {}};
    for (const BlockBasis& block : basis.blocks)
        for (int row = 0; row < view_terms; ++row) {
            for (int c = 0; c < 3; ++c) image.values.push_back(block.mean(row, c));
            for (int k = 0; k < basis.rank; ++k) image.values.push_back(block.u(row, k));
        }
    return image;
}

void take_basis_image(const std::filesystem::path& path, ViewBasis& basis) {
    const ExrImage image = read_exr(path, {"coefficient"}, {{3 + basis.rank, view_terms * int(basis.cubes.size())}});
    const float* value = image.values.data();
    for (size_t b = 0; b < basis.cubes.size(); ++b) {
        BlockBasis& block = basis.blocks.emplace_back();
        block.u.resize(view_terms, basis.rank);
        for (int row = 0; row < view_terms; ++row) {
            for (int c = 0; c < 3; ++c) block.mean(row, c) = *value++;
            for (int k = 0; k < basis.rank; ++k) block.u(row, k) = *value++;
        }
    }
}

TexelFitNotes notes_of(const ViewBasisFit& fit) {
    const ViewBasis& b = fit.basis;
    const Json own = {{"surface_side", fit.surface_side}, {"rank", b.rank},         {"degree", view_degree},
                      {"noise", double(b.noise)},         {"up", numbers_of(b.up)}, {"origin", numbers_of(b.origin)},
                      {"cube", double(b.cube)},           {"cubes", b.cubes}};
    return {view_basis_name, view_basis_name, own.dump()};
}

void take_notes(const std::string& model, const std::string& own_json, ViewBasisFit& fit) {
    if (model != view_basis_name) throw std::runtime_error("its model is no view basis");
    const Json own = Json::parse(own_json);
    ViewBasis& b = fit.basis;
    if (own.at("degree") != view_degree) throw std::runtime_error("its polynomials are of another degree");
    fit.surface_side = own.at("surface_side").get<int>();
    ViewBasisOptions options;
    options.rank = b.rank = own.at("rank").get<int>();
    b.noise = own.at("noise").get<float>();
    options.noise = double(b.noise);
    check_options(options);
    b.up = vector_of(own.at("up"));
    b.origin = vector_of(own.at("origin"));
    b.cube = own.at("cube").get<float>();
    b.cubes = own.at("cubes").get<std::vector<std::array<int32_t, 3>>>();
    if (b.cubes.empty() || b.cubes.size() > 1'000'000 || !std::ranges::is_sorted(b.cubes) || !(b.cube >= 0))
        throw std::runtime_error("its cubes are none, or in no order");
}

}  // namespace

std::vector<TexelMap> maps_of(const ViewBasis& basis) {
    std::vector<TexelMap> maps;
    for (int k = 0; k < basis.rank; ++k) maps.push_back({fmt::format("z{:02}.exr", k), {"R", "G", "B"}, 3 * size_t(k)});
    return maps;
}

void write_fit(const std::filesystem::path& folder, const ViewBasisFit& fit, const TriangleAtlas& atlas,
               const std::function<void(const std::filesystem::path&)>& add_files) {
    write_texel_fit(folder, fit, notes_of(fit), atlas, maps_of(fit.basis), fit.parameters, [&](const auto& place) {
        write_exr(place / basis_name, basis_image(fit.basis));
        if (add_files) add_files(place);
    });
}

StoredViewBasis read_view_basis(const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
    StoredViewBasis stored;
    ViewBasisFit& fit = stored.fit;
    TexelFitReader reader(
        folder, view_basis_name, [&](const auto& model, const auto& own) { take_notes(model, own, fit); }, fit);
    take_basis_image(folder / basis_name, fit.basis);
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    if (stored.dataset->mesh.triangles.empty()) throw UserError(folder.string() + ": its dataset has no mesh");
    stored.atlas = std::make_unique<TriangleAtlas>(stored.dataset->mesh, fit.surface_side);
    fit.parameters = reader.maps(*stored.atlas, maps_of(fit.basis));
    return stored;
}

}  // namespace radiafit
