#pragma once
#include "eval/safe_relighting.h"
#include "fitting/fitted.h"
#include "publish/page_model.h"

/// Pages of the families of models. The fit, its atlas and the dataset must outlive what they return, and stay where
/// they are.
namespace radiafit::tools {

PageModel page_model_of(const LightFieldFit& fit, const Mesh& mesh);
/// training: the views that were fitted.
PageModel page_model_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                        const std::vector<uint32_t>& training);
PageModel page_model_of(const ViewBasisFit& fit, const TriangleAtlas& atlas);
PageModel page_model_of(const SgFit& fit, const TriangleAtlas& atlas);
PageModel page_model_of(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
                        const std::vector<uint32_t>& training);
/// Whether a page's texels have sRGB's values, of a fit in this space; else they are linear.
bool shows_stored_srgb(const Dataset& dataset, TargetSpace space);
/// What bounds a texel-local model that is shown safely: albedo, brightest; and the way back from these two, decoded.
std::vector<PageMap> bound_maps(const std::vector<SafeRelighting::Bounds>& bounds, const Atlas& atlas);
std::vector<SafeRelighting::Bounds> bounds_of(const PageMap* decoded, const Atlas& atlas);
/// The number of each texel's block of the surface.
PageMap block_map(const BasisBlocks& blocks, const Atlas& atlas);
/// Whether normals are finer than a mesh's, or a plane's, so that a page needs a map of them; the map; and the atlas
/// with such a map's normals, decoded, of triangles' tiles of this side.
bool has_normal_map(const Dataset& dataset);
PageMap normal_map(const Atlas& atlas);
/// Normals [texels] that are only for highlights, in steps of a byte. over_grid: in the axes of its plane, without z.
PageMap fit_normal_map(std::span<const Vec3f> normals, const Atlas& atlas, bool over_grid);
std::unique_ptr<Atlas> atlas_with(const PageMap& normals, const Atlas& atlas, const Dataset& dataset, int side);
/// What a page needs to show a fit of any family.
PageModel page_model_of(Fitted& fitted);

}  // namespace radiafit::tools
