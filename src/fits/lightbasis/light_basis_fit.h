#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "eval/contestant.h"
#include "eval/safe_relighting.h"
#include "fit/fit_folder.h"
#include "fit/texel_fit.h"
#include "lightbasis/learn_light_basis.h"

namespace radiafit::fits {

inline constexpr const char* light_basis_name = "lightbasis";  ///< of the model in requests and in fit.json

/// A problem per texel.
struct LightBasisFit : FitRecord {
    int surface_side = 16;  ///< of a mesh's atlas; unused for a grid
    LightBasis basis;
    const TexelModel* underneath = nullptr;  ///< what the basis adds to; null: nothing
    std::vector<float> parameters;           ///< [texels][rank of z, then the parameters of the model underneath]
    size_t numbers() const { return size_t(basis.rank) + (underneath ? size_t(underneath->parameters) : 0); }
};
/// The model underneath, as a fit.
ReflectanceFit underneath_of(const LightBasisFit& fit);

/// All of a basis but its blocks' numbers, as JSON.
std::string description_of(const LightBasis& basis);
/// The same the other way round; throws std::runtime_error or what nlohmann throws.
LightBasis described_light_basis(const std::string& json);
/// Where parameters are stored in images.
std::vector<TexelMap> maps_of(const LightBasisFit& fit);

/// As those of fit/fit_folder.h.
void write_fit(const std::filesystem::path& folder, const LightBasisFit& fit, const Atlas& atlas,
               const std::function<void(const std::filesystem::path& temporary_folder)>& add_files = {});
struct StoredLightBasis {
    LightBasisFit fit;
    std::unique_ptr<Dataset> dataset;
    std::unique_ptr<Atlas> atlas;
};
StoredLightBasis read_light_basis(const std::filesystem::path& folder, const std::filesystem::path& moved_to = {});

/// Where lamps leave the directions that were fitted: cosines of normals with these count as no less, and nothing gets
/// brighter by more.
inline constexpr float least_cosine = 0.05f, most_bright = 2;

/// The turns that take the directions to a view's lamp and camera, as the surface's middle sees them, to the nearest
/// ones amid the training views'.
struct InwardTurns {
    Eigen::Matrix3f lamp, camera;

    /// What a basis has of a texel that sees lamp and camera in these directions (world).
    LampAndHalf turned(const LightBasis& basis, const Frame& frame, const Vec3f& to_lamp,
                       const Vec3f& to_camera) const {
        return basis.directions_of(frame.to_local(lamp * to_lamp), frame.to_local(camera * to_camera));
    }
};
InwardTurns turns_inside(const Dataset& dataset, const std::vector<uint32_t>& training, const View& view);

/// Where a lamp's direction leaves the cone of the training lamps', the basis says nothing: all lamps' directions are
/// turned back into it, as the surface's centre sees them, and the surface darkens by the cosine with its normal. A
/// basis that knows half vectors has the view turned back, too, into the cone of the training cameras. Upon a model the
/// basis fades with that (SafeRelighting). `training`: the views that were fitted; bounds: [texels], of the model
/// underneath, used instead of finding them. All but bounds must outlive the contestant.
Contestant contestant_of(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
                         const std::vector<uint32_t>& training, std::vector<SafeRelighting::Bounds> bounds = {});

}  // namespace radiafit::fits
