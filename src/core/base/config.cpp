#include "base/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

// Malformed files are to be reported, not to end a debug build: the library has an error for each of its assertions.
#define TOML_ASSERT(expression) static_assert(true)
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <type_traits>

#include "base/error.h"
#include "base/json.h"
#include "base/wording.h"

namespace radiafit {
namespace {

std::string as_given(const std::string& override_text) {
    return fmt::format("{} {}", at_command_line("--set", "override"), override_text);
}

std::string text_of(const auto& value) { return json_text(nlohmann::json(value), -1, NotUtf8::replace); }

std::string_view type_name(const toml::node& node) {
    if (node.is_table()) return "a table";
    if (node.is_array()) return "a list";
    if (node.is_string()) return "a string";
    if (node.is_integer()) return "an integer";
    if (node.is_floating_point()) return "a number";
    if (node.is_boolean()) return "true or false";
    return "a date or time";
}

/// What a message says was expected.
constexpr std::string_view expected(const bool&) { return "true or false"; }
constexpr std::string_view expected(const int&) { return "an integer of 32 bits"; }
constexpr std::string_view expected(const int64_t&) { return "an integer"; }
constexpr std::string_view expected(const double&) { return "a finite number"; }
constexpr std::string_view expected(const std::string&) { return "a string"; }
constexpr std::string_view expected(const std::vector<std::string>&) { return "a list of strings"; }
constexpr std::string_view expected(const std::vector<int>&) { return "a list of integers of 32 bits"; }
constexpr std::string_view expected(const std::vector<double>&) { return "a list of finite numbers"; }

bool convert(const toml::node& node, bool& out) {
    if (const auto* value = node.as_boolean()) return out = value->get(), true;
    return false;
}

template <std::signed_integral Integer>
bool convert(const toml::node& node, Integer& out) {
    const auto* value = node.as_integer();
    if (!value || value->get() < std::numeric_limits<Integer>::min() ||
        value->get() > std::numeric_limits<Integer>::max())
        return false;
    out = static_cast<Integer>(value->get());
    return true;
}

bool convert(const toml::node& node, double& out) {
    if (const auto* integer = node.as_integer()) return out = static_cast<double>(integer->get()), true;
    const auto* value = node.as_floating_point();
    if (!value || !std::isfinite(value->get())) return false;
    out = value->get();
    return true;
}

bool convert(const toml::node& node, std::string& out) {
    if (const auto* value = node.as_string()) return out = value->get(), true;
    return false;
}

template <class T>
bool convert(const toml::node& node, std::vector<T>& out) {
    const auto* list = node.as_array();
    if (!list) return false;
    out.assign(list->size(), T{});
    for (size_t i = 0; i < out.size(); i++)
        if (!convert(*list->get(i), out[i])) return false;
    return true;
}

/// toml++ is undefined on some characters outside of strings: control characters, and those beyond ASCII.
bool plain(unsigned char c) { return (c >= ' ' && c < 127) || c == '\t' || c == '\n' || c == '\r'; }

/// Comments may hold what they like beyond ASCII. A quote before it may end a string that began lines above, so that
/// what follows is no comment.
void refuse_strange_characters(const std::filesystem::path& path, const std::string& text) {
    size_t line = 1;
    bool comment = false, quote = false;
    for (const char c : text) {
        if (!plain(static_cast<unsigned char>(c)) && (static_cast<signed char>(c) >= 0 || !comment || quote))
            throw UserError(
                fmt::format("{}:{}: a character that is no printable ASCII; in strings, write \\u and four "
                            "hexadecimal digits",
                            path.string(), line));
        comment |= c == '#';
        quote |= c == '"' || c == '\'';
        if (c != '\n') continue;
        ++line;
        comment = quote = false;
    }
}

/// Says where the value came from if the rule does not hold for it.
template <class T>
void judge(const std::string& where, const T& value, const std::function<void(const T&)>& rule) {
    try {
        rule(value);
    } catch (const UserError& e) {
        throw UserError(fmt::format("{}: {}", where, e.what()));
    }
}

/// A rule for lists from the rule for their entries.
template <class T, class Rule>
std::function<void(const std::vector<T>&)> for_each_of(std::string_view key, const Rule& rule) {
    return [key, rule](const std::vector<T>& list) {
        if (list.empty()) throw UserError(fmt::format("{} = []: give one or more", key));
        for (const T& entry : list) rule(entry);
    };
}

template <class T>
std::function<void(const T&)> within(std::string_view key, const Range<T>& range) {
    return [key, range](const T& value) { require(key, value, range); };
}

toml::table parse_file(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw UserError(fmt::format("{}: no such configuration file; check the path", path.string()));
    std::ifstream stream(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    refuse_strange_characters(path, text);
    try {
        return toml::parse(text, path.string());
    } catch (const toml::parse_error& parse_error) {
        throw UserError(fmt::format("{}:{}: {}; correct the line", path.string(), parse_error.source().begin.line,
                                    parse_error.description()));
    }
}

}  // namespace

size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);  // distances of a's first i bytes to every beginning of b
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < a.size(); i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < b.size(); j++) {
            const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
    const auto best = std::ranges::min_element(
        known, {}, [word](const std::string& candidate) { return edit_distance(word, candidate); });
    return best == known.end() ? "" : *best;
}

struct Config::Sources {
    /// One key as given somewhere: `where` is "FILE:LINE", or as_given() with the value's text in `override_text`.
    struct Entry {
        std::string key;
        const toml::node* node;
        std::string where;
        std::optional<std::string> override_text;
        bool applies;  // false: it is in another profile, and is only checked
    };

    toml::table file;
    std::vector<toml::table> overrides;
    std::vector<Entry> entries;  // later ones override earlier ones
    std::vector<std::pair<std::string, std::string>> resolved;

    void add_table(const toml::table& table, const std::filesystem::path& path, bool applies) {
        for (const auto& [key, node] : table)
            entries.push_back({.key = std::string(key.str()),
                               .node = &node,
                               .where = fmt::format("{}:{}", path.string(), key.source().begin.line),
                               .override_text = {},
                               .applies = applies});
    }

    /// Takes [profile.*] out of the file's table and adds each.
    void add_profiles(const toml::node& profiles, const std::filesystem::path& path, const std::string& selected) {
        std::vector<std::string> names;
        const toml::table* chosen = nullptr;
        const auto* tables = profiles.as_table();
        if (!tables)
            throw UserError(fmt::format("{}:{}: 'profile' must hold tables such as [profile.smoke]", path.string(),
                                        profiles.source().begin.line));
        for (const auto& [key, node] : *tables) {
            const auto* table = node.as_table();
            if (!table)
                throw UserError(fmt::format("{}:{}: 'profile.{}' must be a table", path.string(),
                                            node.source().begin.line, key.str()));
            names.emplace_back(key.str());
            if (key.str() == selected)
                chosen = table;
            else
                add_table(*table, path, false);
        }
        if (chosen)
            add_table(*chosen, path, true);
        else if (!selected.empty())
            throw UserError(
                fmt::format("{}: no profile '{}'; choose one of: {}", path.string(), selected, fmt::join(names, ", ")));
    }

    void add_override(const std::string& text) {
        const size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0)
            throw UserError(fmt::format("{}: write it as key=value", as_given(text)));
        const std::string value = text.substr(equals + 1);
        toml::table table;
        try {
            if (std::ranges::all_of(value, plain)) table = toml::parse("value = " + value);
        } catch (const toml::parse_error&) {  // a bare word
        }
        if (!table.contains("value")) table.insert("value", value);  // is a string
        overrides.push_back(std::move(table));
        entries.push_back({.key = text.substr(0, equals),
                           .node = nullptr,
                           .where = as_given(text),
                           .override_text = value,
                           .applies = true});
    }
};

Config::Config(std::filesystem::path path, std::string profile, const std::vector<std::string>& overrides)
    : path_(std::move(path)), profile_(std::move(profile)), sources_(std::make_unique<Sources>()) {
    sources_->file = parse_file(path_);
    sources_->add_table(sources_->file, path_, true);
    const auto is_profile = [](const Sources::Entry& entry) { return entry.key == "profile"; };
    std::erase_if(sources_->entries, is_profile);
    if (const toml::node* profiles = sources_->file.get("profile"))
        sources_->add_profiles(*profiles, path_, profile_);
    else if (!profile_.empty())
        throw UserError(
            fmt::format("{}: no profile '{}'; add a table [profile.{}]", path_.string(), profile_, profile_));
    for (const std::string& text : overrides) sources_->add_override(text);
    size_t next = 0;  // the tables no longer move, so their nodes can be pointed at
    for (Sources::Entry& entry : sources_->entries)
        if (!entry.node) entry.node = sources_->overrides[next++].get("value");
}

Config::~Config() = default;

template <class T>
void Config::read_any(std::string_view key, T& value, const std::function<void(const T&)>& rule) {
    for (const Sources::Entry& entry : sources_->entries) {
        if (entry.key != key) continue;
        T given{};
        if (!convert(*entry.node, given)) {
            bool taken = false;
            if constexpr (std::is_same_v<T, std::string>) {
                taken = entry.override_text.has_value();  // --set name=2024 is a string if a string is wanted
                if (taken) given = *entry.override_text;
            }
            if (!taken)
                throw UserError(fmt::format("{}: '{}' must be {}, not {}", entry.where, key, expected(value),
                                            type_name(*entry.node)));
        }
        if (rule) judge(entry.where, given, rule);
        if (entry.applies) value = std::move(given);
    }
    auto& resolved = sources_->resolved;
    const auto known = std::ranges::find_if(resolved, [key](const auto& pair) { return pair.first == key; });
    if (known == resolved.end())
        resolved.emplace_back(key, text_of(value));
    else
        known->second = text_of(value);
}

void Config::read(std::string_view key, bool& value) { read_any(key, value); }
void Config::read(std::string_view key, int& value) { read_any(key, value); }
void Config::read(std::string_view key, int64_t& value) { read_any(key, value); }
void Config::read(std::string_view key, double& value) { read_any(key, value); }
void Config::read(std::string_view key, std::string& value) { read_any(key, value); }
void Config::read(std::string_view key, std::vector<std::string>& value) { read_any(key, value); }
void Config::read(std::string_view key, std::vector<int>& value) { read_any(key, value); }
void Config::read(std::string_view key, std::vector<double>& value) { read_any(key, value); }

void Config::read(std::string_view key, int& value, const Range<int>& range) {
    read_any<int>(key, value, within(key, range));
}
void Config::read(std::string_view key, double& value, const Range<double>& range) {
    read_any<double>(key, value, within(key, range));
}
void Config::read(std::string_view key, std::string& value, const NameRule& rule) {
    read_any<std::string>(key, value, rule);
}
void Config::read(std::string_view key, std::vector<int>& value, const Range<int>& range) {
    read_any<std::vector<int>>(key, value, for_each_of<int>(key, within(key, range)));
}
void Config::read(std::string_view key, std::vector<double>& value, const Range<double>& range) {
    read_any<std::vector<double>>(key, value, for_each_of<double>(key, within(key, range)));
}
void Config::read(std::string_view key, std::vector<std::string>& value, const NameRule& rule) {
    read_any<std::vector<std::string>>(key, value, for_each_of<std::string>(key, rule));
}

void Config::finish() const {
    std::vector<std::string> known;
    for (const auto& [key, value] : sources_->resolved) known.push_back(key);
    for (const Sources::Entry& entry : sources_->entries) {
        if (std::ranges::find(known, entry.key) != known.end()) continue;
        const std::string suggestion = nearest(entry.key, known);
        throw UserError(fmt::format("{}: unknown key '{}'{}", entry.where, entry.key,
                                    suggestion.empty() ? "" : fmt::format("; did you mean '{}'?", suggestion)));
    }
}

void Config::reject(std::string_view key, std::string_view message) const {
    std::string where = path_.string();
    for (const Sources::Entry& entry : sources_->entries)
        if (entry.applies && entry.key == key) where = entry.where;
    throw UserError(fmt::format("{}: '{}' {}", where, key, message));
}

const std::vector<std::pair<std::string, std::string>>& Config::resolved() const { return sources_->resolved; }

}  // namespace radiafit
