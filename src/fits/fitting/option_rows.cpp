#include "fitting/option_rows.h"

#include <nlohmann/json.hpp>

namespace radiafit::fits::rows {
namespace {

std::string with_dashes(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

}  // namespace

std::string dumped(const std::string& value) {
    return nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
std::string dumped(double value) { return nlohmann::json(value).dump(); }

FitOption option(const char* name, Meaning meaning, const char* help) {
    FitOption o;
    o.name = name;
    o.flag = "--" + with_dashes(name);
    o.help = help;
    o.meaning = std::move(meaning);
    return o;
}

FitOption flag(const char* name, Meaning meaning, bool FitRequest::*member, const char* flag, const char* help) {
    FitOption o = option(name, std::move(meaning), help);
    o.flag = flag;
    o.values = "true, false";
    o.flag_value = member;
    o.read = [member, plain = std::string(name)](FitRequest& r, const std::string& text) {
        r.*member = choose<bool>(plain, text, {{"true", true}, {"false", false}});
    };
    o.text = [member](const FitRequest& r) { return r.*member ? "true" : "false"; };
    o.json = o.text;
    return o;
}

FitOption by_data(FitOption o) {
    o.hide_default = true;
    return o;
}
FitOption of_problem(FitOption o) {
    o.states_problem = true;
    return o;
}
FitOption of_resources(FitOption o) {
    o.decides_result = false;
    return o;
}

}  // namespace radiafit::fits::rows
