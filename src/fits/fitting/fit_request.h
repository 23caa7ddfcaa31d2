#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "compute/compute_options.h"
#include "fitting/own_options.h"
#include "fragment/fragment_options.h"
#include "geometry/surface_lookup.h"
#include "gl/context_options.h"
#include "model/lfm.h"
#include "model/texel_options.h"
#include "optim/methods.h"
#include "reference/ceres_options.h"
#include "samples/record_options.h"

namespace radiafit {
class Journal;
struct VertexSolverOptions;
}  // namespace radiafit

namespace radiafit::fits {

enum class EngineKind { cpu, fragment, compute };
enum class DistributorKind { cpu, gl };
enum class PriorKind { none, surface };          ///< of texels
enum class SampleUse { cached, redistributed };  ///< of compute shaders
enum class ImageSource { disk, disk_cold, memory, device };

/// What to fit with. Every member but those from `scratch` on is an option of the table in fitting/fit_options.h, which
/// says what it means, what values it takes and which fits it means something to.
struct FitRequest {
    std::string model_name = lfm_name;           ///< one of Family::models(), which decides the family
    std::string solver = "stream";               ///< a name in solvers()
    std::string ceres = CeresOptions().setting;  ///< a name in ceres_settings()
    EngineKind engine = EngineKind::cpu;
    const Method* optimizer = methods;  ///< null: Levenberg-Marquardt, of texel-local models on the CPU
    int history = OptimizerOptions().history;
    double learning_rate = 0.02;
    Mode mode = Mode::modern;  ///< of the optimizer and of the bounds penalty
    Passes passes = Passes::combined;
    Storage storage = Storage::fp32;
    Sums sums = Sums::fp32;
    SampleUse samples = SampleUse::cached;
    Accumulate accumulate = Accumulate::gather;
    DistributorKind distributor = DistributorKind::cpu;
    ImageSource source = ImageSource::memory;
    TargetSpace space = TargetSpace::stored;
    ContextOptions context;
    /// Of light field maps; surface_side and loss hold for other models, too. Its mode and mu are not read: mode and mu
    /// of the request replace them in model_options().
    LfmOptions model;
    SurfaceLookup surface = SurfaceLookup::nearest;
    /// If not 0, each triangle gets a side by its size in the photographs: with_sides() fills model.sides, unless they
    /// are given.
    double texels_per_pixel = 0;
    float clip_above = 0, shadow_below = 0;  ///< see TexelOptions
    std::optional<ValueCurve> curve = {};    ///< of models under lamps; none: value_curve()'s choice
    PriorKind prior = PriorKind::none;
    double mu = -1;  ///< weight of the bounds; below 0: the mode's default
    bool deflate = false;
    int iterations = 25;
    int validation = 0;
    std::string leave_out;  ///< names of training images, with commas between them
    double stop_residual = 0, stop_output_change = 0;
    uint64_t seed = 1;
    RecordKind record = RecordKind::compact;
    uint64_t memory = 0;                       ///< bytes; a fit that needs more is made in parts; 0: no limit
    uint64_t sort_memory = uint64_t(1) << 30;  ///< bytes
    std::string records;                       ///< folder that keeps them; empty: they are deleted after the fit
    int refills = 0;
    OwnOptions of_families;  ///< options that single families have; read by own()

    std::filesystem::path scratch;     ///< folder of records that are deleted; empty: the system's for temporary files
    std::shared_ptr<Journal> journal;  ///< problems that an interrupted run has finished; null: none are kept
    double checkpoint_s = 10;          ///< seconds between writes of the journal to disk; 0: never
    bool cold = false;                 ///< drop records from the page cache before they are read
    bool part = false;                 ///< fit a part of a surface (fitting/parts/parts.h); no image needs to show it
    int left_out = 0;                  ///< OptimizerOptions::left_out: corrections of the paper to do without
    float first_step = 1;              ///< OptimizerOptions::first_step
    bool cull = true;                  ///< FragmentOptions::cull

    /// The options of a single family, by the type of their struct.
    template <class Block>
    const Block& own() const {
        return of_families.get<Block>();
    }
    template <class Block>
    Block& own() {
        return of_families.get<Block>();
    }

    /// The option by its name in the table. Throws UserError for a value that it does not take.
    FitRequest& set(const std::string& option, const std::string& value);
    std::string text(const std::string& option) const;  ///< as set() takes it
    /// Throws UserError for a value out of range, options that exclude one another, or a solver of other models. An
    /// option that means nothing to this fit is no error here; see reject_idle_options().
    void check() const;
    std::string json() const;  ///< every option, as one JSON object

    const TexelModel* texel_model() const { return find_texel_model(model_name); }  ///< null: none of them
    Rule rule() const;
    float bounds_weight() const;     ///< mu, or the mode's default
    ValueCurve value_curve() const;  ///< curve, or the model's default: sRGB's of light bases, linear of others
    OptimizerOptions optimizer_options() const;
    LfmOptions model_options() const;    ///< with mode and mu filled in, checked
    TexelOptions texel_options() const;  ///< checked
    FragmentOptions fragment_options() const;
    StreamOptions stream_options() const;  ///< of images that are distributed in every sweep
    bool has_prior() const;                ///< and does something with it
    bool levenberg_marquardt() const { return optimizer == nullptr; }
    VertexSolverOptions vertex_solver_options() const;
    bool on_engine(EngineKind kind) const;  ///< of solvers that run on an engine
    bool lacks_engine() const;              ///< which its model is not fitted on
    bool on_fragment_engine() const { return on_engine(EngineKind::fragment); }
    bool redistributes() const;  ///< on compute shaders
    std::string label() const;   ///< "cg-modern", as the trace's solver column
};

}  // namespace radiafit::fits
