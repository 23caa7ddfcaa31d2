#pragma once
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fitting/fit_facts.h"

/// The options of a fit: one table. From it come the command line of fit and plan, fit.json, options in experiments'
/// configs, the refusal of options that mean nothing to a fit, and docs/options.md. Rows of a single family come from
/// the family (fitting/family.h).
namespace radiafit::fits {

struct FitOption {
    std::string name;   ///< in fit.json and configs: "surface_side"
    std::string flag;   ///< on the command line: "--surface-side"; "--deflate,!--joint" of a switch
    std::string group;  ///< under which --help and docs/options.md list it
    std::string help;
    std::string values;                   ///< "paper, modern", "a whole number from 1 to 16", "a folder"
    std::vector<std::string> choices;     ///< where values are names
    std::string type = "TEXT";            ///< in --help
    Meaning meaning;                      ///< of a fit that has the option, if families alone have it
    std::vector<const Family*> families;  ///< the only ones that have it; empty: all may
    bool hide_default = false;
    bool states_problem = false;             ///< says what the problems are, not how they are solved
    bool names_input = false;                ///< its value may be a file that the fit reads
    bool decides_result = true;              ///< false: a fit comes out the same whatever its value
    bool FitRequest::*flag_value = nullptr;  ///< of a switch
    /// Throws UserError.
    std::function<void(FitRequest& request, const std::string& text)> read;
    std::function<std::string(const FitRequest& request)> text;
    std::function<std::string(const FitRequest& request)> json;  ///< the value, as JSON
    std::function<void(const FitRequest& request)> check;        ///< of a number's range; throws UserError

    std::string first_flag() const { return flag.substr(0, flag.find(',')); }  ///< "--deflate"
    bool means_something(const FitFacts& fit) const;
};
std::span<const FitOption> fit_options();
/// Throws UserError that names the nearest option.
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

/// Throws UserError if an option has another value than its default and means nothing to the fit.
void reject_idle_options(const FitRequest& request, bool grid);

}  // namespace radiafit::fits
