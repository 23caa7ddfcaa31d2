#include "capture/image_finder.h"

#include <fmt/format.h>
#include <utf8proc.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/read_file.h"
#include "capture/file_names.h"
#include "image/image_format.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

bool is_photograph(const fs::path& file) {
    const ImageFormat* format = format_of_name(file);
    return format && format->photograph;
}

/// The name without an ending of photographs: "shot.01.jpeg" and "shot.01" are "shot.01".
std::string without_ending(const std::string& name) {
    return is_photograph(name) ? fs::path(name).stem().string() : name;
}

/// Without an ending of any files, such as a camera's own format, from which photographs were made: a letter and up to
/// three more letters or digits.
std::string without_any_ending(const std::string& name) {
    const std::string ending = fs::path(name).extension().string();
    const auto is = [&](size_t i, int (*kind)(int)) { return kind(static_cast<unsigned char>(ending[i])) != 0; };
    bool known = ending.size() >= 2 && ending.size() <= 5 && is(1, std::isalpha);
    for (size_t i = 2; i < ending.size(); ++i) known = known && is(i, std::isalnum);
    return known ? fs::path(name).stem().string() : name;
}

/// None of what is no UTF-8.
std::optional<std::string> mapped(const std::string& name, utf8proc_option_t options) {
    utf8proc_uint8_t* result = nullptr;
    const utf8proc_ssize_t size =
        utf8proc_map(reinterpret_cast<const utf8proc_uint8_t*>(name.data()), static_cast<utf8proc_ssize_t>(name.size()),
                     &result, static_cast<utf8proc_option_t>(options | UTF8PROC_STABLE));
    const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> owner(result, std::free);
    if (size < 0) return {};
    return std::string(reinterpret_cast<const char*>(result), static_cast<size_t>(size));
}

fs::path joined(const std::vector<fs::path>& parts) {
    fs::path path;
    for (const fs::path& part : parts) path /= part;
    return path;
}

}  // namespace

std::string composed_name(const std::string& name) { return mapped(name, UTF8PROC_COMPOSE).value_or(name); }

std::string comparable_name(const std::string& name) {
    const auto folded = mapped(name, static_cast<utf8proc_option_t>(UTF8PROC_COMPOSE | UTF8PROC_CASEFOLD));
    return folded ? *folded : lower_case(name);
}

ImageFinder::ImageFinder(fs::path folder, fs::path list) : folder_(std::move(folder)), list_(std::move(list)) {}

std::optional<fs::path> ImageFinder::find(const std::string& name) {
    const fs::path as_given = fs::path(name).lexically_normal();
    if (as_given.is_relative() && as_given.has_filename()) {
        if (auto file = exact(as_given)) return file;
        // NeRF's own sets leave endings out.
        if (!as_given.has_extension())
            if (auto file = alike({as_given.begin(), as_given.end()}, as_given.filename().string(), Endings::vary))
                if (fs::path(*file).replace_extension() == as_given) return file;
    }
    std::string slashes = name;
    std::ranges::replace(slashes, '\\', '/');
    const fs::path whole = fs::path(slashes).lexically_normal();
    const std::vector<fs::path> parts(whole.begin(), whole.end());
    std::vector<Parts> tails;  // the path, then without its first folders
    for (size_t first = 0; first < parts.size(); ++first)
        if (parts[first].is_relative() && parts[first] != "..")
            tails.emplace_back(parts.begin() + ptrdiff_t(first), parts.end());
    for (const Parts& tail : tails)
        if (auto file = exact(joined(tail)))
            return guessed(tail.size() == parts.size() ? "with backslashes" : "by other folders", name, *file);
    for (const Parts& tail : tails)
        if (auto file = alike(tail, tail.back().string(), Endings::count))
            return guessed("in other letters", name, *file);
    for (const auto& shorten : {without_ending, without_any_ending})
        for (const Parts& tail : tails)
            if (auto file = alike(tail, shorten(tail.back().string()), Endings::vary))
                return guessed("by another ending", name, *file);
    if (path_exists(folder_ / as_given)) return as_given;  // a folder, which reading complains of
    return {};
}

std::optional<fs::path> ImageFinder::exact(const fs::path& path) const {
    const fs::path file = folder_ / path;
    if (!path_exists(file) || folder_exists(file)) return {};
    return path;
}

/// Goes down the folders of the path, each of which has to be the only one alike, to a file of such a name.
std::optional<fs::path> ImageFinder::alike(const Parts& path, const std::string& file_name, Endings endings) {
    fs::path found;
    for (size_t i = 0; i < path.size(); ++i) {
        const bool last = i + 1 == path.size(), stems = last && endings == Endings::vary;
        if (!last && (path[i] == ".." || path[i] == ".")) {
            found /= path[i];
            continue;
        }
        const std::string wanted = comparable_name(last ? file_name : path[i].string());
        const Listing& listing = list(found);
        const Names& names = !last ? listing.folders : stems ? listing.stems : listing.files;
        const auto [match, behind] = names.equal_range(wanted);
        if (match == behind) return {};
        if (std::next(match) != behind)
            throw UserError(fmt::format("{}: '{}' may be {} or {}: take one away", list_.string(),
                                        joined(path).string(), (folder_ / found / match->second).string(),
                                        (folder_ / found / std::next(match)->second).string()));
        found /= match->second;
    }
    return found;
}

const ImageFinder::Listing& ImageFinder::list(const fs::path& folder) {
    const auto [entry, is_new] = listings_.try_emplace(folder);
    Listing& listing = entry->second;
    if (!is_new) return listing;
    std::error_code error;  // of a folder that cannot be listed nothing is found
    fs::directory_iterator entries(folder_ / folder, error);
    std::set<fs::path> files;  // in one order on every machine
    for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
        std::error_code ignored;
        if (is_hidden(entries->path())) continue;
        const std::string name = entries->path().filename().string();
        if (entries->is_directory(ignored))
            listing.folders.emplace(comparable_name(name), name);
        else
            files.insert(name);
    }
    for (const fs::path& file : files) {
        listing.files.emplace(comparable_name(file.string()), file.string());
        if (is_photograph(file)) listing.stems.emplace(comparable_name(without_ending(file.string())), file.string());
    }
    return listing;
}

fs::path ImageFinder::guessed(const char* how, const std::string& name, fs::path file) {
    Guess& guess = guesses_[how];
    if (guess.count++ == 0) guess = {1, name, (folder_ / file).string()};
    return file;
}

std::vector<std::string> ImageFinder::remarks() const {
    std::vector<std::string> lines;
    for (const auto& [how, guess] : guesses_)
        lines.push_back(fmt::format("{} names {} photograph{} {}: '{}' is {}", list_.string(), guess.count,
                                    guess.count == 1 ? "" : "s", how, guess.name, guess.file));
    return lines;
}

std::string ImageFinder::missing(const std::string& name) const {
    const fs::path path = folder_ / name;
    const std::string looked = fs::path(name).is_absolute() || name.find('\\') != std::string::npos
                                   ? fmt::format("'{}', in {}", name, folder_.string())
                                   : path.string();
    return fmt::format("{}: no such image, but {} names it", looked, list_.string());
}

}  // namespace radiafit::tools
