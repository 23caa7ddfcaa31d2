#include "samples/record_description.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/nesting.h"
#include "base/read_file.h"
#include "base/wording.h"

namespace radiafit {
namespace {

/// Of everything but the checksum itself.
uint64_t checksum_of(nlohmann::ordered_json description) {
    description.erase("checksum");
    const std::string text = description.dump();
    return hash_bytes(text.data(), text.size());
}

}  // namespace

void throw_damaged_records(const std::filesystem::path& file) {
    throw UserError(fmt::format("{}: {}; delete the folder {}, it is made anew", file.string(),
                                stands(file) ? "damaged" : "missing", file.parent_path().string()));
}

InputFile open_records_file(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) throw_damaged_records(file);
    return InputFile(file);
}

void write_description(const std::filesystem::path& file, const std::string& object) {
    auto description = nlohmann::ordered_json::parse(object);
    description["checksum"] = checksum_of(description);
    write_file(file, description.dump(1) + "\n");
}

std::string read_description(const std::filesystem::path& file, const std::string& format, const std::string& key) {
    std::string text;
    if (stands(file)) text = read_file(file, "description of records");
    if (nested_deeper(text, 100)) throw_damaged_records(file);
    const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
    const auto is = [&](const char* name, const nlohmann::ordered_json& value) {
        return json.is_object() && json.contains(name) && json.at(name) == value;
    };
    if (!is("format", format) || !is("version", 1))
        throw UserError(
            fmt::format("{}: holds no whole records; choose another {} folder", file.string(), option_name("records")));
    if (!is("checksum", checksum_of(json))) throw_damaged_records(file);
    if (!is("key", key))
        throw UserError(fmt::format("{}: records of another dataset or of other options; choose another {} folder",
                                    file.string(), option_name("records")));
    return json.dump();
}

}  // namespace radiafit
