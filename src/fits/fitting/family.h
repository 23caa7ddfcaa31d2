#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "fitting/fit_options.h"
#include "fitting/fitted.h"
#include "fitting/solvers/solve.h"
#include "fitting/tune_candidate.h"

/// The families of models: light field maps, texel-local models, view bases, spherical Gaussians,
/// light bases. What commands ask of
/// one is said here, once; they themselves never ask which it is.
namespace radiafit::fits {

struct Solver;

struct FinishedFit {
    FitRun run;
    Fitted fit;
    std::string times_json;  ///< the family's own entries among fit.json's times
    std::string note;        ///< for the closing line: "4096 texels, 3 underdetermined, "
};

class Divided;

/// Whether the user gave an option, such as "--optimizer".
using Given = std::function<bool(const char* flag)>;

/// A model for a dataset, with options that suit it.
struct Chosen {
    FitSetting setting;                ///< the model first
    std::function<std::string()> why;  ///< by the data; null: options that are given leave no choice
};

struct Family {
    const char* name;                        ///< in messages
    bool (*owns)(const std::string& model);  ///< by its name in requests and in fit.json
    std::vector<std::string> (*models)();    ///< their names
    const char* help;                        ///< of the models, after "--model"
    std::vector<FitOption> (*options)() = [] { return std::vector<FitOption>(); };  ///< its rows; equal ones count once
    bool has_error_bars;                                                            ///< find_error_bars()
    ModelKind kind;
    std::optional<SolverFacts> (*facts)(const Solver& solver);  ///< how it fits this family; none: it fits no such
    /// The space of images that are streamed with 16 bits; none where a fit reads the values themselves.
    std::optional<TargetSpace> (*streamed)(const FitRequest& request);
    /// For users who name no model, with the options that they gave in `request`; nothing: none of its models suits the
    /// dataset.
    std::optional<Chosen> (*choose)(const Given& given, const Dataset& dataset, const FitRequest& request);
    /// What the user left open and the dataset decides.
    void (*resolve_options)(const Given& given, const Dataset& dataset, FitRequest& request);
    /// What `tune` tries of it; none: none of its models suits the dataset.
    std::vector<TuneCandidate> (*candidates)(const Dataset& dataset);
    Plan (*plan)(const Dataset& dataset, const FitRequest& request, size_t most_views);
    FinishedFit (*fit)(const Dataset& dataset, const FitRequest& request);
    /// For a fit in parts (fitting/parts/parts.h).
    std::unique_ptr<Divided> (*divide)(const Dataset& dataset, const FitRequest& request);
    /// The problems that the request's fit solves, and what its solution is judged by (docs/problems.md).
    void (*export_problems)(const Dataset& dataset, const FitRequest& request, ProblemFolder& out);
    /// moved_to: where the dataset is now; empty: where the fit says. Throws UserError.
    Fitted (*open)(const std::filesystem::path& folder, const std::filesystem::path& moved_to);
};
extern const Family light_field_maps, texel_local_models, view_bases, spherical_gaussians, light_bases;
/// In the order of preference where a dataset and the options given leave a choice.
std::span<const Family* const> families();

const Family& family_of(const FitRequest& request);
/// Family::open of the family whose model the folder's fit has. Throws UserError.
Fitted open_fit(const std::filesystem::path& folder, const std::filesystem::path& moved_to = {});

/// The trivial baseline of what light does not change: a mean colour per texel, of the views that `like` fitted, in its
/// space. `dataset` must outlive it.
Fitted mean_colours(const Dataset& dataset, const FitRecord& like, const LfmOptions& sides);

/// The trivial baseline of what lamps change: albedos, of texels of this side where there is a mesh, without that
/// validation's views. `dataset` must outlive it.
Fitted lambertian(const Dataset& dataset, int surface_side, int validation, float clip_above = 0,
                  float shadow_below = 0);
/// A side for the texels of a mesh: that of its normals, where they are finer than its vertices.
int reflectance_side(const Dataset& dataset);

void export_light_field_problems(const Dataset& dataset, const FitRequest& request, ProblemFolder& out);
void export_texel_problems(const Dataset& dataset, const FitRequest& request, ProblemFolder& out);
void export_parameters(const LightFieldFit& fit, const Mesh& mesh, ProblemFolder& out);
void export_parameters(const ReflectanceFit& fit, ProblemFolder& out);

Plan plan_light_field(const Dataset& dataset, const FitRequest& request, size_t most_views);
Plan plan_texels(const Dataset& dataset, const FitRequest& request, size_t most_views);

/// For lamps that move, of the models that take the given options: the one that predicts images best that it has not
/// seen (fitting/families/lamp_contest.h); the first of them where there are too few to leave some out, and lambert
/// below 4. Reflectance models leave out saturated pixels and cast shadows (--clip-above 0.98 --shadow-below 0.1).
std::optional<Chosen> choose_texel_model(const Given& given, const Dataset& dataset, const FitRequest& request);
std::vector<TuneCandidate> texel_candidates(const Dataset& dataset);

std::unique_ptr<Divided> divide_light_field(const Dataset& dataset, const FitRequest& request);
std::unique_ptr<Divided> divide_texels(const Dataset& dataset, const FitRequest& request);
/// `dataset` must outlive it.
FinishedFit finished_light_field(LightFieldFit fit, FitRun run, const ResamplingCounts& resampling,
                                 const Dataset& dataset);
FinishedFit finished_reflectance(ReflectanceOutcome outcome, const Dataset& dataset);

/// The request that a fit answers, as far as its record says. Throws UserError.
FitRequest fitted_request(const FitRecord& fit);
/// FitRequest::validation of a fit. Throws UserError.
int validation_of(const FitRecord& fit);
/// The training views that it fitted. Throws UserError.
std::vector<uint32_t> fitted_views(const Dataset& dataset, const FitRecord& fit);

}  // namespace radiafit::fits
