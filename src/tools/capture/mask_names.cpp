#include "capture/mask_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>

#include "base/error.h"
#include "capture/file_names.h"
#include "capture/image_finder.h"
#include "image/image_format.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

/// A mask's name without its ending is `before` + the photograph's name, with or without its ending, + `behind`.
struct Habit {
    const char* shown;
    const char* before;
    bool ending;
    const char* behind;
    bool in_subfolder;

    std::string name_for(const fs::path& photograph) const {
        return before + photograph.stem().string() + (ending ? photograph.extension().string() : "") + behind;
    }
    fs::path folder_for(const fs::path& photograph) const {
        return in_subfolder ? photograph.parent_path() : fs::path();
    }
    /// "NAME_mask.png, without subfolders"
    std::string description(const fs::path& example) const {
        return fmt::format("{}{}{}", shown, lower_ending(example), in_subfolder ? "" : ", without subfolders");
    }
};

/// In the order in which they are preferred.
constexpr std::array<Habit, 12> habits = {{{"NAME", "", false, "", true},
                                           {"NAME.EXT", "", true, "", true},
                                           {"NAME_mask", "", false, "_mask", true},
                                           {"NAME.mask", "", false, ".mask", true},
                                           {"NAME.EXT.mask", "", true, ".mask", true},
                                           {"mask_NAME", "mask_", false, "", true},
                                           {"NAME", "", false, "", false},
                                           {"NAME.EXT", "", true, "", false},
                                           {"NAME_mask", "", false, "_mask", false},
                                           {"NAME.mask", "", false, ".mask", false},
                                           {"NAME.EXT.mask", "", true, ".mask", false},
                                           {"mask_NAME", "mask_", false, "", false}}};

/// The name as names of photographs are looked up: its ending in small letters, all of it composed.
std::string key_of(const std::string& name) {
    return composed_name(fs::path(name).stem().string() + lower_ending(name));
}

/// The pictures of one folder by their names without ending.
using Pictures = std::multimap<std::string, fs::path>;

Pictures list_pictures(const fs::path& folder) {
    Pictures pictures;
    std::error_code error;
    fs::directory_iterator entries(folder, error);
    for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
        const fs::path file = entries->path();
        const ImageFormat* format = format_of_name(file);
        if (format && format->photograph && !is_hidden(file)) pictures.emplace(key_of(file.stem().string()), file);
    }
    return pictures;  // of a folder that cannot be listed, none: its photographs are then named as those without masks
}

/// What follows one habit.
struct Matches {
    const Habit* habit = nullptr;
    std::vector<std::vector<fs::path>> files;  ///< [photographs], several where endings differ by letter case
    std::set<fs::path> distinct;
};

class Finder {
public:
    Finder(const fs::path& masks, const fs::path& images, const std::vector<std::string>& names, bool png_alone)
        : masks_(masks), images_(images), names_(names), png_alone_(png_alone) {}

    Matches find(const Habit& habit) {
        Matches matches{&habit, {}, {}};
        for (const std::string& name : names_) {
            matches.files.push_back(find(habit, name));
            matches.distinct.insert(matches.files.back().begin(), matches.files.back().end());
        }
        return matches;
    }

private:
    std::vector<fs::path> find(const Habit& habit, const fs::path& name) {
        const fs::path folder = masks_ / habit.folder_for(name);
        auto listed = listed_.find(folder);
        if (listed == listed_.end()) listed = listed_.emplace(folder, list_pictures(folder)).first;
        std::vector<fs::path> files;
        const auto [first, last] = listed->second.equal_range(key_of(habit.name_for(name)));
        for (auto it = first; it != last; ++it) {
            std::error_code ignored;  // of what is no file, reading says so
            if (!fs::equivalent(it->second, images_ / name, ignored)) files.push_back(it->second);
        }
        std::sort(files.begin(), files.end());
        if (png_alone_) std::erase_if(files, [](const fs::path& file) { return lower_ending(file) != ".png"; });
        return files;
    }

    const fs::path &masks_, &images_;
    const std::vector<std::string>& names_;
    bool png_alone_;
    std::map<fs::path, Pictures> listed_;
};

std::string expected_name(const Habit& habit, const fs::path& photograph, const std::string& ending = ".png") {
    return (habit.folder_for(photograph) / (habit.name_for(photograph) + ending)).string();
}

[[noreturn]] void fail_none(const fs::path& masks, const std::string& name) {
    throw UserError(
        fmt::format("{}: no mask for any image: expected, for image '{}', {}, {}, {}, {} or {}, or such names of JPEG "
                    "or TIFF files",
                    masks.string(), name, expected_name(habits[0], name), expected_name(habits[1], name),
                    expected_name(habits[2], name), expected_name(habits[3], name), expected_name(habits[5], name)));
}

/// Every photograph has one mask, and no two have the same.
void check(const fs::path& masks, const std::vector<std::string>& names, const Matches& chosen,
           const std::vector<Matches>& all) {
    std::map<fs::path, size_t> taken;
    size_t missing = 0, first_missing = 0, example = 0;
    for (size_t i = names.size(); i-- > 0;) {
        const auto& files = chosen.files[i];
        if (files.empty()) {
            ++missing;
            first_missing = i;
            continue;
        }
        example = i;
        if (files.size() > 1)
            throw UserError(fmt::format("{} and {} may both be the mask of image '{}': take one away",
                                        files[0].string(), files[1].string(), names[i]));
        if (const auto [other, is_new] = taken.emplace(files[0], i); !is_new)
            throw UserError(fmt::format("{}: may be the mask of image '{}' or of '{}': name the masks {}",
                                        files[0].string(), names[i], names[other->second],
                                        chosen.habit->in_subfolder ? "NAME.EXT.png" : "as the images, in subfolders"));
    }
    if (missing == 0) return;
    std::string text =
        fmt::format("{}: no mask for image '{}' ({} of {} images have none): expected {}, as '{}' has {}",
                    masks.string(), names[first_missing], missing, names.size(),
                    expected_name(*chosen.habit, names[first_missing], chosen.files[example][0].extension().string()),
                    names[example], chosen.files[example][0].lexically_relative(masks).string());
    for (const Matches& other : all)
        if (const auto& files = other.files[first_missing]; !files.empty())
            throw UserError(fmt::format("{}; {} is named otherwise: name all alike", text,
                                        files[0].lexically_relative(masks).string()));
    throw UserError(text);
}

}  // namespace

MaskNames match_masks(const fs::path& masks, const fs::path& images, const std::vector<std::string>& names) {
    const bool subfolders = std::any_of(names.begin(), names.end(),
                                        [](const std::string& name) { return fs::path(name).has_parent_path(); });
    std::vector<Matches> all;
    for (const bool png_alone : {true, false}) {  // beside masks as PNG, pictures of other formats are drawings of them
        Finder finder(masks, images, names, png_alone);
        all.clear();
        for (const Habit& habit : habits)
            if (habit.in_subfolder || subfolders) all.push_back(finder.find(habit));
        if (std::ranges::any_of(all, [](const Matches& matches) { return !matches.distinct.empty(); })) break;
    }
    const Matches& chosen = *std::max_element(all.begin(), all.end(), [](const Matches& a, const Matches& b) {
        return a.distinct.size() < b.distinct.size();
    });
    if (chosen.distinct.empty()) fail_none(masks, names[0]);
    check(masks, names, chosen, all);

    MaskNames result;
    for (const auto& files : chosen.files) result.files.push_back(files[0]);
    result.remark = fmt::format("masks are named {}: '{}' has {}", chosen.habit->description(result.files[0]), names[0],
                                result.files[0].lexically_relative(masks).string());
    std::set<fs::path> seen = chosen.distinct;
    for (const Matches& other : all) {
        std::vector<fs::path> aside;
        std::copy_if(other.distinct.begin(), other.distinct.end(), std::back_inserter(aside),
                     [&](const fs::path& file) { return seen.insert(file).second; });
        if (!aside.empty())
            result.notes.push_back(fmt::format("{}: {} masks that are named {} are left aside, such as {}",
                                               masks.string(), aside.size(), other.habit->description(aside[0]),
                                               aside[0].lexically_relative(masks).string()));
    }
    return result;
}

}  // namespace radiafit::tools
