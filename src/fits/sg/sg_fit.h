#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "eval/contestant.h"
#include "fit/fit_folder.h"
#include "fit/texel_fit.h"
#include "sg/solve_sg.h"

namespace radiafit::fits {

inline constexpr const char* sg_name = "sg";  ///< of the model in requests and in fit.json

/// A problem per texel.
struct SgFit : FitRecord {
    int surface_side = 8;
    int lobes = 4;
    Vec3f up = Vec3f::UnitY();
    std::vector<float> parameters;  ///< as SgSolution's
    ColourSum colours;              ///< of all samples; not stored with the fit
};

/// Where parameters are stored in images.
std::vector<TexelMap> sg_maps(int lobes);

/// As those of fit/fit_folder.h.
void write_fit(const std::filesystem::path& folder, const SgFit& fit, const TriangleAtlas& atlas,
               const std::function<void(const std::filesystem::path& temporary_folder)>& add_files = {});
struct StoredSg {
    SgFit fit;
    std::unique_ptr<Dataset> dataset;
    std::unique_ptr<TriangleAtlas> atlas;
};
StoredSg read_sg(const std::filesystem::path& folder, const std::filesystem::path& moved_to = {});

/// The fit must be of texels in this atlas; both outlive the contestant.
Contestant contestant_of(const SgFit& fit, const TriangleAtlas& atlas);

}  // namespace radiafit::fits
