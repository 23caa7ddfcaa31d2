#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/range.h"

/// Strict configuration files. Defaults live in the struct that is configured; a key nobody reads is an error.
///
///     iterations = 100              # top level: every profile
///     [profile.smoke]
///     iterations = 5                # this profile only
///
///     struct Options { int iterations = 25; };
///     Config config(path, "smoke", overrides);
///     config.read("iterations", options.iterations);
///     config.finish();
namespace radiafit {

/// Levenshtein distance in bytes: fewest insertions, deletions and replacements.
size_t edit_distance(std::string_view a, std::string_view b);
/// The known word nearest to `word`, the first of equals; empty if none is known. For "did you mean".
std::string nearest(std::string_view word, const std::vector<std::string>& known);

class Config {
public:
    /// `profile`: the table [profile.NAME] to lay over the top level, empty for none.
    /// `overrides`: "key=value" texts, laid over both; a value is TOML, or else taken as a string.
    /// Throws UserError with file and line: unreadable or malformed file, no such profile.
    explicit Config(std::filesystem::path path, std::string profile = "",
                    const std::vector<std::string>& overrides = {});
    ~Config();
    Config(const Config&) = delete;
    Config& operator=(const Config&) = delete;

    /// Overwrites `value` if the key is given, else leaves the default. Throws UserError with file and line on a
    /// wrong type, in any profile. A double takes an integer too; it must be finite.
    void read(std::string_view key, bool& value);
    void read(std::string_view key, int& value);
    void read(std::string_view key, int64_t& value);
    void read(std::string_view key, double& value);
    void read(std::string_view key, std::string& value);
    void read(std::string_view key, std::vector<std::string>& value);
    void read(std::string_view key, std::vector<int>& value);
    void read(std::string_view key, std::vector<double>& value);

    /// The same for values that a rule holds for: a number's range, or for a name a function that throws UserError. Of
    /// a list it holds for every entry, and there is at least one.
    using NameRule = std::function<void(const std::string& name)>;
    void read(std::string_view key, int& value, const Range<int>& range);
    void read(std::string_view key, double& value, const Range<double>& range);
    void read(std::string_view key, std::string& value, const NameRule& rule);
    void read(std::string_view key, std::vector<int>& value, const Range<int>& range);
    void read(std::string_view key, std::vector<double>& value, const Range<double>& range);
    void read(std::string_view key, std::vector<std::string>& value, const NameRule& rule);

    /// Throws UserError for the first key, in any profile, that was never read, with the nearest one that was.
    void finish() const;

    /// For a caller's additional checks of a value: "FILE:LINE: 'KEY' MESSAGE" where the key's value came from.
    [[noreturn]] void reject(std::string_view key, std::string_view message) const;

    /// Every key read so far, in that order, with its value (default or given) as JSON text.
    const std::vector<std::pair<std::string, std::string>>& resolved() const;
    const std::filesystem::path& path() const { return path_; }
    const std::string& profile() const { return profile_; }

private:
    struct Sources;
    template <class T>
    void read_any(std::string_view key, T& value, const std::function<void(const T&)>& rule = {});

    std::filesystem::path path_;
    std::string profile_;
    std::unique_ptr<Sources> sources_;
};

}  // namespace radiafit
