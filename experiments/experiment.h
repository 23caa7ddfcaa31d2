#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/config.h"
#include "base/output_lock.h"
#include "base/record.h"
#include "eval/judge.h"
#include "fitting/solvers/solve.h"
#include "report/result_archive.h"
#include "report/result_folder.h"
#include "synthetic/synthetic.h"

namespace radiafit {
class Context;
}  // namespace radiafit

/// What every experiment shares: its command line, its config, the datasets it asks for, and where its rows go.
namespace radiafit::harness {

/// The paper's claims are judged on pictures as graphics hardware draws them: a pixel is what its centre sees.
inline const JudgeOptions at_pixel_centres{.pixel_points = 1};

/// What --run is followed by: an earlier run, whose figure alone is to be drawn; or runs, to be judged in place of the
/// checkout's.
enum class RunOption { figure, results };

class Experiment {
public:
    /// NAME [--config FILE] [--profile smoke|standard|paper] [--set key=value ...] [--output FOLDER] [--resume]
    /// [--threads N] [--minutes N], or NAME --run FOLDER [--output FOLDER]. The checkout that datasets, results and
    /// figures lie in is the config file's, or else the one that it is run in.
    Experiment(std::string name, int argc, const char* const* argv, RunOption run_option);

    /// Whether nothing is left to measure: an earlier run's figure was asked for, and is drawn now; or with --resume
    /// `results` hold a run of this revision, machine and profile.
    bool done();

    Config& config() { return *config_; }
    const std::string& profile() const { return profile_; }
    const std::string& name() const { return name_; }

    /// The synthetic dataset of this profile's scale, generated if it isn't there yet. run.json notes what was opened.
    /// `variant` names one whose images differ; another seed makes another object of the shape, and names it too.
    Dataset dataset(const std::string& shape, const OrnamentOptions& ornament = {}, const std::string& variant = {},
                    uint64_t seed = SyntheticOptions().seed) const;

    /// A packed dataset at any place, such as a capture.
    Dataset open(const std::filesystem::path& folder) const;

    /// What run.json of results opened from now on will hold.
    Record& record() { return record_; }
    /// Opens the result folder: results/NAME/DEVICE/UTC-REVISION. Call once the config is finished. `device`: OpenGL's
    /// renderer or cpu_device().
    ResultFolder open_results(const std::string& device) const;
    /// Gives the result folder its name, and shows it: draws paper_figs/NAME.gp over the rows and copies NAME.md
    /// from among them; says where everything lies.
    void finish(ResultFolder& results, const std::string& caption) const;
    const std::filesystem::path& root() const { return root_; }  ///< the checkout
    /// Where rows go: the checkout's `results`, or what --output says.
    std::filesystem::path results() const { return output_.empty() ? root_ / "results" : output_; }
    /// Where figures go: paper_figs; paper_figs/PROFILE for other profiles than the standard one; or what --output
    /// says.
    std::filesystem::path figures() const;
    /// Whether it runs by the checkout's config file, with nothing else set. Only such runs count as "the" run of
    /// their profile; the figures of others lie among their rows.
    bool standard() const { return standard_; }
    /// "cpu, 2 threads": in rows, the renderer of a figure that the CPU made.
    std::string cpu_name() const;
    /// "AMD EPYC 7763, 2 threads": in captions, and for the folder of results that no OpenGL made.
    std::string cpu_device() const;

private:
    /// The record names it, once.
    Dataset noted(Dataset dataset) const;
    void redraw(const std::filesystem::path& run) const;
    bool finished_before() const;

    std::string name_, profile_ = "standard";
    std::filesystem::path root_, output_, run_;
    bool standard_ = true, resume_ = false;
    std::unique_ptr<UnpackedResults> unpacked_;
    std::unique_ptr<OutputLock> lock_;  ///< of its results: two runs at once would measure each other
    std::unique_ptr<Config> config_;
    Record record_;
};

/// An option of fits, as the command line takes it.
void read_option(Config& config, FitRequest& request, const std::string& name);
/// For Config::read(): throws UserError for a text that the option does not take.
std::function<void(const std::string&)> valid_option(const std::string& name);

/// The record names the OpenGL that made the outcome, if any did; or the context's.
void note_gl(const FitRun& run, Record& record);
void note_gl(const Context& context, Record& record);

/// halves.csv of the OpenGL that these options name.
void write_halves(const ResultFolder& results, const ContextOptions& context);

/// solve() on shared samples with its progress shown and its OpenGL, if any, noted in the record; errors
/// [iterations + 1][problem] are E_t, those of the start first.
FitOutcome solve_noting_errors(const Dataset& dataset, const FitRequest& request, const SharedSamples& samples,
                               std::vector<std::vector<float>>& errors, Record& record);

/// Points (x, y) of a figure's lines, by the lines' names.
using Points = std::vector<std::pair<double, double>>;
/// Least-squares slope of log y over log x; points: at least two different x.
double log_slope(const Points& points);

/// Rules for the names of synthetic datasets in a config: any, or those that a light field map can be fitted to. Throw
/// UserError that lists the names there are.
void check_shape(const std::string& shape);
void check_light_field_shape(const std::string& shape);
/// Reads surface_side, view_side and lambda, the weight of both kinds of maps.
void read_maps(Config& config, LfmOptions& model);

/// `count` of the views, evenly spread; 0, or more than there are: all.
std::vector<uint32_t> spread_views(const std::vector<uint32_t>& views, int count);

/// Runs body and turns exceptions into one line and an exit status (2: the user's mistake).
int run_experiment(const std::string& name, int argc, const char* const* argv,
                   const std::function<void(Experiment&)>& body, RunOption run_option = RunOption::figure);

}  // namespace radiafit::harness
