#include "base/made_by.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/atomic_file.h"
#include "base/json.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format_name = "radiafit-made";
constexpr int format_version = 1;
constexpr std::string_view word_begins = "radiafit_made_by_";
constexpr size_t key_digits = 16, longest_command = 64;
// Where remarks stand: films have theirs behind a table of all frames.
constexpr uint64_t searched_at_begin = 4 << 20, searched_at_end = 64 << 10;

bool is_key(std::string_view text) {
    return text.size() == key_digits &&
           std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) || (c >= 'a' && c <= 'f'); });
}

/// What stands behind the key, in a PNG a checksum, may look like more of the word.
std::optional<MadeBy> word_in(std::string_view bytes) {
    for (size_t at = 0; (at = bytes.find(word_begins, at)) != std::string_view::npos;) {
        at += word_begins.size();
        for (size_t end = at; end < bytes.size() && end < at + longest_command; ++end) {
            const char c = bytes[end];
            if (c == '_' && end > at && is_key(bytes.substr(end + 1, key_digits))) {
                std::string command(bytes.substr(at, end - at));
                std::ranges::replace(command, '_', ' ');
                return MadeBy{command, std::string(bytes.substr(end + 1, key_digits))};
            }
            if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') break;
        }
    }
    return {};
}

std::string bytes_of(const fs::path& file, uint64_t from, uint64_t count) {
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(count, '\0');
    stream.seekg(std::streamoff(from));
    stream.read(bytes.data(), std::streamsize(bytes.size()));
    bytes.resize(size_t(std::max<std::streamsize>(stream.gcount(), 0)));
    return bytes;
}

std::optional<MadeBy> made_by_of_file(const fs::path& file) {
    std::error_code error;
    const uint64_t size = fs::file_size(file, error);
    if (error) return {};
    if (const auto made = word_in(bytes_of(file, 0, std::min(size, searched_at_begin)))) return made;
    if (size <= searched_at_begin) return {};
    return word_in(bytes_of(file, size - searched_at_end, searched_at_end));
}

/// Discarded where there is none.
Json note_in(const fs::path& folder) {
    std::error_code error;
    const fs::path file = folder / made_by_name;
    if (!fs::is_regular_file(fs::symlink_status(file, error))) return Json(Json::value_t::discarded);
    const uint64_t size = fs::file_size(file, error);
    if (error || size > (uint64_t(64) << 20)) return Json(Json::value_t::discarded);
    Json json = parse_json<Json>(bytes_of(file, 0, size));
    const bool ours = json.is_object() && json.value("format", Json()) == format_name &&
                      json.value("version", Json()) == format_version && json.value("command", Json()).is_string() &&
                      json.value("key", Json()).is_string() && json.value("files", Json()).is_object();
    return ours ? json : Json(Json::value_t::discarded);
}

}  // namespace

std::string made_by_word(const MadeBy& made) {
    std::string command = made.command;
    std::ranges::replace(command, ' ', '_');
    return fmt::format("{}{}_{}", word_begins, command, made.key);
}

void write_made_by(const fs::path& folder, const MadeBy& made) {
    Json files = Json::object();
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[entry.path().lexically_relative(folder).string()] = entry.file_size();
    const Json json = {{"format", format_name},
                       {"version", format_version},
                       {"command", made.command},
                       {"key", made.key},
                       {"files", files}};
    write_file(folder / made_by_name, json_text(json, 1, NotUtf8::replace) + "\n");
}

std::optional<MadeBy> made_by(const fs::path& output) {
    std::error_code error;
    const fs::file_status status = fs::status(output, error);
    if (fs::is_regular_file(status)) return made_by_of_file(output);
    if (!fs::is_directory(status)) return {};
    const Json note = note_in(output);
    if (note.is_discarded()) return {};
    return MadeBy{note["command"].get<std::string>(), note["key"].get<std::string>()};
}

bool is_listed(const fs::path& folder, const fs::path& name) {
    const Json note = note_in(folder);
    return !note.is_discarded() && note["files"].contains(name.string());
}

bool as_it_was_made(const fs::path& folder) {
    const Json note = note_in(folder);
    if (note.is_discarded()) return false;
    return std::ranges::all_of(note["files"].items(), [&](const auto& file) {
        std::error_code error;
        const uint64_t size = fs::file_size(folder / file.key(), error);
        return !error && file.value() == Json(size);
    });
}

}  // namespace radiafit
