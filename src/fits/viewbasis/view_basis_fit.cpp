#include "viewbasis/view_basis_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/error.h"
#include "base/json.h"
#include "fit/texel_fit.h"
#include "image/exr.h"
#include "viewbasis/texel_contestant.h"

namespace radiafit::fits {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* basis_name = "basis.exr";

std::array<int, 2> size_of(const ViewBasis& basis) { return {3 + basis.rank, view_terms * int(basis.cubes.size())}; }

}  // namespace

std::string description_of(const ViewBasis& basis) {
    Json own = {
        {"rank", basis.rank}, {"degree", view_degree}, {"noise", double(basis.noise)}, {"up", numbers_of(basis.up)}};
    own.update(parse_json<Json>(description_of(static_cast<const BasisBlocks&>(basis))));
    return json_text(own);
}

ViewBasis described_basis(const std::string& json) {
    const Json own = parse_json<Json>(json);
    ViewBasis b{described_blocks(json)};
    if (own.at("degree") != view_degree) throw std::runtime_error("its polynomials are of another degree");
    b.rank = own.at("rank").get<int>();
    b.noise = own.at("noise").get<float>();
    check_options({.rank = b.rank});
    if (!(b.noise > 0)) throw std::runtime_error("its noise is no number above 0");
    b.up = vector_of(own.at("up"));
    return b;
}

std::vector<TexelMap> maps_of(const ViewBasis& basis) {
    std::vector<TexelMap> maps;
    for (int k = 0; k < basis.rank; ++k) maps.push_back({fmt::format("z{:02}.exr", k), {"R", "G", "B"}, 3 * size_t(k)});
    return maps;
}

void write_fit(const std::filesystem::path& folder, const ViewBasisFit& fit, const TriangleAtlas& atlas,
               const std::function<void(const std::filesystem::path&)>& add_files) {
    Json own = {{"surface_side", fit.surface_side}};
    own.update(parse_json<Json>(description_of(fit.basis)));
    write_texel_fit(folder, fit, {view_basis_name, view_basis_name, json_text(own)}, atlas, maps_of(fit.basis),
                    fit.parameters, [&](const auto& place) {
                        const auto [width, height] = size_of(fit.basis);
                        write_exr(place / basis_name, {width, height, {"coefficient"}, fit.basis.numbers, {}});
                        if (add_files) add_files(place);
                    });
}

StoredViewBasis read_view_basis(const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
    StoredViewBasis stored;
    ViewBasisFit& fit = stored.fit;
    const TakeNotes take = [&](const std::string& model, const std::string& own) {
        if (model != view_basis_name) throw std::runtime_error("its model is no view basis");
        fit.surface_side = parse_json<Json>(own).at("surface_side").get<int>();
        fit.basis = described_basis(own);
    };
    TexelFitReader reader(folder, view_basis_name, take, fit);
    fit.basis.numbers = read_exr(folder / basis_name, {"coefficient"}, size_of(fit.basis)).values;
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    if (stored.dataset->mesh.triangles.empty()) throw UserError(folder.string() + ": its dataset has no mesh");
    stored.atlas = std::make_unique<TriangleAtlas>(stored.dataset->mesh, fit.surface_side);
    fit.parameters = reader.maps(*stored.atlas, maps_of(fit.basis));
    return stored;
}

Contestant contestant_of(const ViewBasisFit& fit, const TriangleAtlas& atlas) {
    return texel_contestant(atlas, fit.surface, fit.space, [&fit, &atlas](uint32_t texel, const Vec3f& eye) {
        const Vec3f position = atlas.position(texel);
        const auto block = fit.basis.block(fit.basis.block_at(position));
        const Frame frame = view_frame(atlas.normal(texel), fit.basis.up);
        const ViewTerms b = view_polynomials(view_direction(frame, position, eye));
        const Eigen::Index rank = fit.basis.rank;
        const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> z(
            &fit.parameters[size_t(texel) * size_t(rank) * 3], 3, rank);
        return Vec3f(block.leftCols<3>().transpose() * b + z * (block.rightCols(rank).transpose() * b));
    });
}

}  // namespace radiafit::fits
