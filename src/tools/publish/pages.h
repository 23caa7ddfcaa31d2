#pragma once
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
/// What a page needs to show a fit of any family.
PageModel page_model_of(Fitted& fitted);

}  // namespace radiafit::tools
