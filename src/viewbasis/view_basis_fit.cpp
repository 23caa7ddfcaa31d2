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

}  // namespace

StoredBasis stored_basis(const ViewBasis& basis) {
    const Json json = {{"rank", basis.rank},
                       {"degree", view_degree},
                       {"noise", double(basis.noise)},
                       {"up", numbers_of(basis.up)},
                       {"origin", numbers_of(basis.origin)},
                       {"cube", double(basis.cube)},
                       {"cubes", basis.cubes}};
    StoredBasis out{json.dump(), {}};
    for (const BlockBasis& block : basis.blocks)
        for (int row = 0; row < view_terms; ++row) {
            for (int c = 0; c < 3; ++c) out.numbers.push_back(block.mean(row, c));
            for (int k = 0; k < basis.rank; ++k) out.numbers.push_back(block.u(row, k));
        }
    return out;
}

ViewBasis described_basis(const std::string& json) {
    const Json own = Json::parse(json);
    ViewBasis b;
    if (own.at("degree") != view_degree) throw std::runtime_error("its polynomials are of another degree");
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
    return b;
}

void take_numbers(std::span<const float> numbers, ViewBasis& basis) {
    if (numbers.size() != size_t(view_terms) * size_t(3 + basis.rank) * basis.cubes.size())
        throw std::runtime_error("its basis is of another size");
    const float* value = numbers.data();
    for (size_t b = 0; b < basis.cubes.size(); ++b) {
        BlockBasis& block = basis.blocks.emplace_back();
        block.u.resize(view_terms, basis.rank);
        for (int row = 0; row < view_terms; ++row) {
            for (int c = 0; c < 3; ++c) block.mean(row, c) = *value++;
            for (int k = 0; k < basis.rank; ++k) block.u(row, k) = *value++;
        }
    }
}

namespace {

TexelFitNotes notes_of(const ViewBasisFit& fit, const StoredBasis& basis) {
    Json own = {{"surface_side", fit.surface_side}};
    own.update(Json::parse(basis.json));
    return {view_basis_name, view_basis_name, own.dump()};
}

void take_notes(const std::string& model, const std::string& own_json, ViewBasisFit& fit) {
    if (model != view_basis_name) throw std::runtime_error("its model is no view basis");
    fit.surface_side = Json::parse(own_json).at("surface_side").get<int>();
    fit.basis = described_basis(own_json);
}

std::array<int, 2> size_of(const ViewBasis& basis) { return {3 + basis.rank, view_terms * int(basis.cubes.size())}; }

}  // namespace

std::vector<TexelMap> maps_of(const ViewBasis& basis) {
    std::vector<TexelMap> maps;
    for (int k = 0; k < basis.rank; ++k) maps.push_back({fmt::format("z{:02}.exr", k), {"R", "G", "B"}, 3 * size_t(k)});
    return maps;
}

void write_fit(const std::filesystem::path& folder, const ViewBasisFit& fit, const TriangleAtlas& atlas,
               const std::function<void(const std::filesystem::path&)>& add_files) {
    const StoredBasis basis = stored_basis(fit.basis);
    write_texel_fit(folder, fit, notes_of(fit, basis), atlas, maps_of(fit.basis), fit.parameters,
                    [&](const auto& place) {
                        const auto [width, height] = size_of(fit.basis);
                        write_exr(place / basis_name, {width, height, {"coefficient"}, basis.numbers, {}});
                        if (add_files) add_files(place);
                    });
}

StoredViewBasis read_view_basis(const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
    StoredViewBasis stored;
    ViewBasisFit& fit = stored.fit;
    TexelFitReader reader(
        folder, view_basis_name, [&](const auto& model, const auto& own) { take_notes(model, own, fit); }, fit);
    take_numbers(read_exr(folder / basis_name, {"coefficient"}, size_of(fit.basis)).values, fit.basis);
    stored.dataset = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to));
    fit.dataset_path = stored.dataset->folder;
    if (stored.dataset->mesh.triangles.empty()) throw UserError(folder.string() + ": its dataset has no mesh");
    stored.atlas = std::make_unique<TriangleAtlas>(stored.dataset->mesh, fit.surface_side);
    fit.parameters = reader.maps(*stored.atlas, maps_of(fit.basis));
    return stored;
}

}  // namespace radiafit
