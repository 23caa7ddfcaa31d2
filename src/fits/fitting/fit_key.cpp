#include "fitting/fit_key.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "base/hash.h"
#include "base/json.h"
#include "base/record.h"
#include "dataset/checksums.h"
#include "fit/fit_folder.h"
#include "fitting/fit_options.h"
#include "ownmodel/own_model.h"

namespace radiafit::fits {
namespace {
using Json = nlohmann::ordered_json;

/// A value as the command line has it.
std::string text_of(const Json& options, const std::string& name) {
    const Json value = options.is_object() && options.contains(name) ? options.at(name) : Json();
    if (value.is_string()) return fmt::format("'{}'", value.get<std::string>());
    return value.is_null() ? "unknown" : value.dump();
}

/// As the command line has it.
std::string flag_of(const std::string& name) {
    for (const FitOption& o : fit_options())
        if (o.name == name) return o.first_flag();
    return "--" + name;
}
}  // namespace

std::string program_key() { return fmt::format("{} {:016x}", git_revision(), file_checksum("/proc/self/exe")); }

std::string fit_key(const Dataset& dataset, const FitRequest& request) {
    Json options = Json::object();
    for (const FitOption& o : fit_options())
        if (o.decides_result) options[o.name] = Json::parse(o.json(request));
    const std::string text = text_of_model(request.model_name);
    return Json{{"program", program_key()},
                {"dataset", fingerprint(dataset).digest},
                {"images", dataset_checksum(dataset)},
                {"options", options},
                {"model_text", text.empty() ? "" : fmt::format("{:016x}", hash_bytes(text.data(), text.size()))}}
        .dump();
}

std::string difference_of_keys(const std::string& there, const std::string& here) {
    if (there == here) return "";
    const Json a = parse_json<Json>(there), b = parse_json<Json>(here);
    if (!a.is_object() || !b.is_object()) return "it is of another kind, or damaged";
    std::vector<std::string> found;
    const auto differ = [&](const char* what) { return a.value(what, Json()) != b.value(what, Json()); };
    if (differ("program"))
        found.push_back(fmt::format("the program is {} there, {} here", text_of(a, "program"), text_of(b, "program")));
    if (differ("dataset"))
        found.push_back("it is of another dataset");
    else if (differ("images"))
        found.push_back("the dataset was made anew since");
    if (differ("problems")) found.push_back("the problems are others");
    if (differ("model_text")) found.push_back("the model's text is another");
    const Json options_there = a.value("options", Json()), options_here = b.value("options", Json());
    if (!options_there.is_object() || !options_here.is_object()) return "it is of another kind, or damaged";
    for (const auto& option : options_here.items())
        if (const std::string x = text_of(options_there, option.key()), y = text_of(options_here, option.key()); x != y)
            found.push_back(fmt::format("{} is {} there, {} here", flag_of(option.key()), x, y));
    return found.empty() ? "it is of another kind, or damaged" : fmt::format("{}", fmt::join(found, "; "));
}

}  // namespace radiafit::fits
