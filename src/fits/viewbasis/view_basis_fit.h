#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "eval/contestant.h"
#include "fit/fit_folder.h"
#include "fit/texel_fit.h"
#include "viewbasis/learn_view_basis.h"

namespace radiafit::fits {

inline constexpr const char* view_basis_name = "viewbasis";  ///< of the model in requests and in fit.json

/// A problem per texel.
struct ViewBasisFit : FitRecord {
    int surface_side = 8;
    ViewBasis basis;
    std::vector<float> parameters;  ///< z: [texels][rank][3]
};

/// All of a basis but its blocks' numbers, as JSON.
std::string description_of(const ViewBasis& basis);
/// The same the other way round; throws std::runtime_error or what nlohmann throws.
ViewBasis described_basis(const std::string& json);
/// Where z is stored in images.
std::vector<TexelMap> maps_of(const ViewBasis& basis);

/// As those of fit/fit_folder.h.
void write_fit(const std::filesystem::path& folder, const ViewBasisFit& fit, const TriangleAtlas& atlas,
               const std::function<void(const std::filesystem::path& temporary_folder)>& add_files = {});
struct StoredViewBasis {
    ViewBasisFit fit;
    std::unique_ptr<Dataset> dataset;
    std::unique_ptr<TriangleAtlas> atlas;
};
StoredViewBasis read_view_basis(const std::filesystem::path& folder, const std::filesystem::path& moved_to = {});

/// The fit must be of texels in this atlas; both outlive the contestant. A pixel's colour is its texel's, as its centre
/// is seen.
Contestant contestant_of(const ViewBasisFit& fit, const TriangleAtlas& atlas);

}  // namespace radiafit::fits
