#pragma once
#include <memory>

#include "eval/safe_relighting.h"
#include "fitting/family.h"
#include "lightbasis/light_basis_fit.h"

/// Light bases of any texels: of a whole surface, of a part, or of some drawn from it.
namespace radiafit::fits {

inline constexpr const char* no_model = "none";  ///< underneath

LightBasisOptions light_basis_options(const FitRequest& request);
size_t light_basis_numbers(const FitRequest& request);  ///< of a texel

/// Throws UserError for a dataset that no light basis can be fitted to.
void require_lit(const Dataset& dataset);

/// What a light basis adds to: a reflectance model that was fitted before. Nothing unless the request names one.
class Underneath {
public:
    Underneath(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
               const SharedTexels& samples, const FitRequest& request);
    /// Of a fit that there is. All must outlive it.
    Underneath(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
               const LightBasisFit& fit);
    Underneath(const Underneath&) = delete;
    Underneath& operator=(const Underneath&) = delete;

    const TexelModel* model() const { return fit_.options.model; }
    LightUnderneath light() const;
    const std::vector<float>& parameters() const { return fit_.parameters; }  ///< [texels][parameters]

private:
    ReflectanceFit fit_;
    std::unique_ptr<const SafeRelighting> safe_;
};

/// Fills what is solved of each texel; the fit has its basis.
void solve_lamp_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                       const SharedTexels& samples, const Underneath& underneath, const FitRequest& request,
                       LightBasisFit& fit, FitRun& run);

/// A light basis, learned from and solved for the texels: what of a fit neither dataset nor request says is filled.
/// learning_s, if given: seconds.
LightBasisFit fit_lamp_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                              const SharedTexels& samples, const FitRequest& request, FitRun* run = nullptr,
                              double* learning_s = nullptr);

/// The samples of some of an atlas' texels alone. texels: [texel_count()]
std::unique_ptr<TexelSource> gather_some(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                                         const FitRequest& request, const std::vector<bool>& texels);

std::unique_ptr<Divided> divide_light_basis(const Dataset& dataset, const FitRequest& request);

}  // namespace radiafit::fits
