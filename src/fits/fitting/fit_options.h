#pragma once
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fitting/fit_request.h"

/// The options of a fit: one table. From it come the command line of fit and plan, fit.json, options in experiments'
/// configs, the refusal of options that mean nothing to a fit, and docs/options.md. A family's own rows come from the
/// family (app/family.h).
namespace radiafit::fits {

struct Family;

/// What a fit does, as far as options are about it: bits, of which solvers and engines state theirs.
namespace use {
enum : uint32_t {
    sides = 1u << 0,       ///< surface maps, or a mesh's texels, have a side
    space = 1u << 1,       ///< residuals may be formed in either space
    maps = 1u << 2,        ///< of a light field map
    smoothness = 1u << 3,  ///< of maps, and their bounds
    bounds = 1u << 4,      ///< penalty
    optimizer = 1u << 5,   ///< one of ours
    iterations = 1u << 6,
    residual = 1u << 7,  ///< stops by it
    change = 1u << 8,    ///< stops by it
    random_start = 1u << 9,
    deflation = 1u << 10,
    engine = 1u << 11,        ///< runs on an engine of choice
    distribution = 1u << 12,  ///< reads a list of samples that was made beforehand
    opengl = 1u << 13,
    passes = 1u << 14,  ///< streams images through fragment programs
    record_kind = 1u << 15,
    records = 1u << 16,  ///< on disk
    refills = 1u << 17,
    ceres = 1u << 18,
    selection = 1u << 19,  ///< leaves samples out by their value
    history = 1u << 20,    ///< of lbfgs
    learning_rate = 1u << 21,
    loss = 1u << 22,
    weights = 1u << 23,
    prior = 1u << 28,            ///< of texels, by the surface's others: of Levenberg-Marquardt
    surface_lookup = 1u << 29,   ///< shows texels of a mesh, so that they may be interpolated
    own_sides = 1u << 25,        ///< triangles' surface maps may differ in side
    accumulation = 1u << 26,     ///< compute shaders over light field maps: where samples and sums come from
    images = 1u << 27,           ///< of these, distributed in every sweep
    interpolation = 1u << 30,    ///< takes colours at texels' centres, whatever the look-up; nothing is distributed
    normal_equations = 1u << 24  ///< has them, so that Levenberg-Marquardt may be its optimizer
};
}  // namespace use

struct FitOption {
    std::string name;   ///< in fit.json and configs: "surface_side"
    std::string flag;   ///< on the command line: "--surface-side"; "--deflate,!--joint" of a switch
    std::string group;  ///< under which --help and docs/options.md list it
    std::string help;
    std::string values;                   ///< "paper, modern", "a whole number from 1 to 16", "a folder"
    std::vector<std::string> choices;     ///< where values are names
    std::string type = "TEXT";            ///< in --help
    uint32_t uses = 0;                    ///< means something to fits that do one of these; 0: to every fit
    std::vector<const Family*> families;  ///< that have it alone; none: it is no family's own
    bool hide_default = false;
    bool FitRequest::*flag_value = nullptr;  ///< of a switch
    /// Throws UserError.
    std::function<void(FitRequest& request, const std::string& text)> read;
    std::function<std::string(const FitRequest& request)> text;
    std::function<std::string(const FitRequest& request)> json;  ///< the value, as JSON
    std::function<void(const FitRequest& request)> check;        ///< of a number's range; throws UserError

    std::string first_flag() const { return flag.substr(0, flag.find(',')); }  ///< "--deflate"
    /// To a fit of the family that does what these bits of `use` say.
    bool means_something(const Family& family, uint32_t does) const;
};
std::span<const FitOption> fit_options();
/// Throws UserError, telling the nearest name.
const FitOption& find_fit_option(const std::string& name);

/// Options by their names in the table, with values as FitRequest::set() takes them.
using FitSetting = std::vector<std::pair<std::string, std::string>>;
/// As the command line has them: "--model lfm --terms 3".
std::string command_line_of(const FitSetting& setting);
/// The other way. Throws UserError for options that there are not, and for one without its value.
FitSetting parse_setting(const std::string& command_line);
/// Whether an option, such as "--terms", is among the setting's. The setting must outlive it.
std::function<bool(const char*)> given_by(const FitSetting& setting);
/// Whether every option that is given means something to the request's fit. given: whether the user gave an option,
/// such as "--terms".
bool takes_given(const std::function<bool(const char*)>& given, const FitRequest& request);

/// What the request's fit does. `grid`: over one, every texel has its own pixel, and nothing is distributed. Throws
/// UserError for a solver that does not fit the request's kind of model.
uint32_t uses_of(const FitRequest& request, bool grid = false);
/// Throws UserError if an option has another value than its default and means nothing to the fit.
void reject_idle_options(const FitRequest& request, bool grid);

}  // namespace radiafit::fits
