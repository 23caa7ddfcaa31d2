#include "cli/shown_fit.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/log.h"
#include "exchange/surface_normals.h"

namespace radiafit::tools {
namespace {

const Atlas& atlas_of(const Fitted& fitted) {
    return std::visit(
        [](const auto& m) -> const Atlas& {
            if constexpr (requires { *m.atlas; })
                return *m.atlas;
            else
                throw std::logic_error("atlas_of: a light field map");
        },
        fitted.model);
}

}  // namespace

Contestant shown_fit(const RenderOptions& options, Fitted& fitted) {
    const Contestant fit = contestant_of(fitted);
    if (!options.enhancement) return fit;
    const Dataset& dataset = fitted.dataset();
    const Atlas& atlas = atlas_of(fitted);
    const SurfaceNormals normals = finest_normals(fit, atlas, dataset, fitted_views(dataset, fitted.record()));
    log_info(normals.lamps > 0
                 ? fmt::format("specular enhancement: by normals found from the fit under {} lamps", normals.lamps)
                 : std::string("specular enhancement: by the dataset's normals"));
    return enhanced(fit, *options.enhancement, atlas, in_world(normals.normals, dataset));
}

void require_lamps(const Fitted& fitted, const char* option) {
    if (!takes_light(fitted))
        throw UserError(
            fmt::format("{}: this fit's model keeps the light that it was photographed under ({}); a model for lamps, "
                        "such as --model lightbasis, is fitted to images whose lamp moves",
                        option, description_of(fitted)));
}

bool is_guess(const Fitted& fitted, double share) {
    constexpr double least = 0.8;  // in the mean over a surface, of which some is always seen from the side
    return share < (takes_light(fitted) ? 1 : least);
}

std::string share_in_words(const Fitted& fitted, double share) {
    const auto* basis = std::get_if<FittedLightBasis>(&fitted.model);
    if (basis && !basis->fit.underneath)
        return basis->fit.basis.by_half() ? "shown as under the nearest lamp and to the nearest camera that were "
                                            "fitted, darkened by the cosine"
                                          : "shown as under the nearest lamp that was fitted, darkened by the cosine";
    if (!takes_light(fitted))
        return fmt::format(
            "{:.0f} % of the fit is shown, the rest is each texel's mean colour; the fit fades from {:.0f} to "
            "{:.0f} degrees from the nearest photograph of a place",
            100 * share, SafeViews::apart / SafeViews::degree,
            (SafeViews::apart + SafeViews::fade) / SafeViews::degree);
    return fmt::format("{:.0f} % of the fit is shown, the rest is Lambertian", 100 * share);
}

void describe_share(const Fitted& fitted, double share) {
    if (!is_guess(fitted, share)) return;
    const std::string what = takes_light(fitted) ? "lamp or camera are far from those of the training images: "
                                                 : "the camera is far from those of the photographs: ";
    log_warning(what + share_in_words(fitted, share));
}

}  // namespace radiafit::tools
