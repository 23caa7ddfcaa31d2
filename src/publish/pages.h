#pragma once
#include "fit/fit_folder.h"
#include "publish/page_model.h"
#include "sg/sg_fit.h"
#include "viewbasis/view_basis_fit.h"

/// Pages of the families of models. The fit, its atlas and the dataset must outlive what they return.
namespace radiafit {

PageModel page_model_of(const LightFieldFit& fit, const Mesh& mesh);
/// training: the views that were fitted.
PageModel page_model_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                        const std::vector<uint32_t>& training);
PageModel page_model_of(const ViewBasisFit& fit, const TriangleAtlas& atlas);
PageModel page_model_of(const SgFit& fit, const TriangleAtlas& atlas);

}  // namespace radiafit
