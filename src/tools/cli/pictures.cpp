#include "cli/pictures.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "base/error.h"
#include "base/log.h"
#include "base/output_claims.h"
#include "image/png_file.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;

/// Pictures carry it near their beginning, films wherever their encoder puts remarks.
bool carries_mark(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return false;
    std::ifstream stream(file, std::ios::binary);
    std::string bytes;
    if (file.extension() == ".mp4" || file.extension() == ".webm") {
        bytes.assign(std::istreambuf_iterator<char>(stream), {});
    } else {
        bytes.resize(1 << 14);
        stream.read(bytes.data(), std::streamsize(bytes.size()));
    }
    return bytes.find(picture_mark) != std::string::npos;
}

}  // namespace

void check_ours(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(fs::symlink_status(file, error)) || carries_mark(file)) return;
    if (file.extension() == ".png" && carries_mark(fs::path(file).replace_extension(".svg"))) return;
    throw UserError(fmt::format("{}: is there, and is no picture of radiafit render; choose another name or remove it",
                                file.string()));
}

fs::path picture_stem(const std::string& output) {
    fs::path stem = output;
    for (const char* extension : {".png", ".exr", ".svg"})
        if (stem.extension() == extension) return stem.replace_extension();
    return stem;
}

Pictures::Pictures(const fs::path& folder, const Background& background)
    : folder_(folder), background_(background), files_(folder) {}

void Pictures::check(const std::string& name, std::initializer_list<const char*> endings) {
    for (const char* ending : endings) {
        checked_.push_back(folder_ / (name + ending));
        check_ours(checked_.back());
        require_replaceable(checked_.back());
    }
}

void Pictures::add(const std::string& name, const LightImage& image) {
    write_light_exr(files_.path() / (name + ".exr"), image);
    add(name, to_bytes(image, background_));
    say(name, fmt::format("{0}.png, {0}.exr", (folder_ / name).string()));
}

void Pictures::add_sheet(const std::string& name, const ByteImage& sheet, const std::string& content) {
    add(name + "_sheet", sheet);
    say(name, fmt::format("{}_sheet.png: {}", (folder_ / name).string(), content));
}

void Pictures::add(const std::string& name, const ProblemPicture& picture) {
    draw_problems(picture, files_.path() / name);
    say(name, fmt::format("{0}.png, {0}.svg", (folder_ / name).string()));
}

void Pictures::commit() {
    for (const fs::path& file : checked_) check_ours(file);  // again: something may be there by now
    files_.commit();
    for (const auto& [name, message] : messages_) log_info(message);
}

void Pictures::say(const std::string& name, std::string message) {
    std::scoped_lock lock(mutex_);
    messages_.emplace(name, std::move(message));
}

void Pictures::add(const std::string& name, const ByteImage& bytes) const {
    write_png(files_.path() / (name + ".png"), bytes.width, bytes.height, bytes.rgb, picture_remark());
}

}  // namespace radiafit::tools
