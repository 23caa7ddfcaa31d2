#pragma once
#include <functional>
#include <optional>

#include "fitting/fit_request.h"

/// What a fit does, as far as options are about it. An option decides by these facts whether it means something to it.
namespace radiafit::fits {

struct Family;

enum class ModelKind {
    light_field,  ///< surface maps and view maps around vertices, or their mean colours
    texel_local,  ///< reflectance in each texel, of datasets with lamps
    by_view,      ///< colours by view direction in each texel
    by_light      ///< colours by lamp direction in each texel, of datasets with lamps
};

/// How a solver fits models of one kind. Rows of the table of solvers, and families, state it.
struct SolverFacts {
    bool iterates = false;
    bool objective = false;     ///< minimizes the paper's objective, penalties included, and may stop at a residual
    bool optimizer = false;     ///< by the method that --optimizer chooses
    bool on_engine = false;     ///< on the engine that --engine chooses
    bool list = false;          ///< reads a list of samples that is made beforehand
    bool records = false;       ///< from disk
    bool mean_colours = false;  ///< of the surface's texels is all that it finds: no view maps
    bool resamples = false;     ///< images to whole light fields, and has to invent what no image shows
    bool ceres = false;         ///< by the setting of Ceres that --ceres chooses
    int most_parameters = 0;    ///< of a texel that it fits; 0: any number
};

struct FitFacts : SolverFacts {
    const Family* family = nullptr;
    ModelKind kind = ModelKind::light_field;
    std::optional<EngineKind> engine = {};  ///< of a solver that runs on one
    const Method* method = nullptr;         ///< of a solver with an optimizer; null: Levenberg-Marquardt
    SampleUse samples = SampleUse::cached;
    SurfaceLookup surface = SurfaceLookup::nearest;
    bool grid = false;  ///< the dataset has one: every texel has its own pixel, and nothing is distributed

    bool light_field() const { return kind == ModelKind::light_field; }
    bool texel_local() const { return kind == ModelKind::texel_local; }
    bool takes_light() const { return texel_local() || kind == ModelKind::by_light; }
    bool on_fragment() const { return engine == EngineKind::fragment; }
    bool on_compute() const { return engine == EngineKind::compute; }

    bool levenberg_marquardt() const { return optimizer && !method; }
    /// Levenberg-Marquardt may be its optimizer.
    bool has_normal_equations() const { return optimizer && texel_local() && !on_fragment() && !on_compute(); }
    bool has_loss() const { return optimizer && method; }
    /// With the penalty of the bounds, until the residual is small: Levenberg-Marquardt knows neither.
    bool minimizes_objective() const { return objective && !levenberg_marquardt(); }
    bool has_prior() const { return texel_local() && levenberg_marquardt(); }
    bool has_view_maps() const { return light_field() && !mean_colours; }
    bool optimizes_maps() const { return light_field() && objective; }
    bool weighs_samples() const { return texel_local() || (light_field() && optimizer); }

    /// Compute shaders sum over a light field map's samples, in one of several ways.
    bool accumulates() const { return light_field() && on_compute(); }
    /// Compute shaders find these samples again in every sweep over the images.
    bool redistributes() const { return accumulates() && samples == SampleUse::redistributed; }
    bool streams_images() const { return on_fragment() || redistributes(); }
    /// Between the centres of a mesh's texels, colours may be interpolated.
    bool looks_up_surface() const { return !takes_light() && !streams_images(); }
    /// Fits colours that are interpolated at texels' centres: no texel takes a pixel.
    bool interpolates() const {
        return kind == ModelKind::by_view || (looks_up_surface() && surface == SurfaceLookup::linear);
    }
    /// A distributor makes its list of samples.
    bool distributes() const {
        const bool listed = list || engine == EngineKind::cpu || (on_compute() && !redistributes());
        return listed && !interpolates() && !grid;
    }
    bool opens_context() const { return on_fragment() || on_compute() || distributes(); }
};

/// Whether an option means something to a fit; empty: to every fit.
using Meaning = std::function<bool(const FitFacts&)>;

/// Throws UserError for a solver that does not fit the request's kind of model. `grid`: the dataset has one.
FitFacts facts_of(const FitRequest& request, bool grid = false);

}  // namespace radiafit::fits
