#include "base/toml.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace radiafit {
namespace {

nlohmann::json to_json(const toml::node& node) {
    if (const toml::table* table = node.as_table()) {
        nlohmann::json object = nlohmann::json::object();
        for (const auto& [key, value] : *table) object[std::string(key)] = to_json(value);
        return object;
    }
    if (const toml::array* array = node.as_array()) {
        nlohmann::json list = nlohmann::json::array();
        for (const toml::node& value : *array) list.push_back(to_json(value));
        return list;
    }
    if (const auto* text = node.as_string()) return text->get();
    if (const auto* number = node.as_integer()) return number->get();
    if (const auto* number = node.as_floating_point()) return number->get();
    if (const auto* truth = node.as_boolean()) return truth->get();
    if (const auto* day = node.as_date())
        return fmt::format("{:04}-{:02}-{:02}", day->get().year, day->get().month, day->get().day);
    throw std::logic_error(fmt::format("line {}: times of day are not read", node.source().begin.line));
}

}  // namespace

std::string json_of_toml(std::string_view text) {
    try {
        return to_json(toml::parse(text)).dump();
    } catch (const toml::parse_error& e) {
        throw std::logic_error(fmt::format("line {}: {}", e.source().begin.line, e.description()));
    }
}

}  // namespace radiafit
