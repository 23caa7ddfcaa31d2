#include "dataset/checksums.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "base/file.h"
#include "base/half.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/made_by.h"
#include "base/parallel.h"
#include "dataset/dataset_json.h"
#include "dataset/truth.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

/// The first channel that is not finite or above the view's peak.
template <class Stored, class ToFloat>
void check_floats(const View& view, std::span<const uint8_t> pixels, const fs::path& images_file, ToFloat to_float) {
    for (size_t i = 0; i < pixels.size() / sizeof(Stored); ++i) {
        Stored stored;
        std::memcpy(&stored, pixels.data() + i * sizeof(Stored), sizeof(Stored));
        const float value = to_float(stored);
        if (!(std::isfinite(value) && value <= view.peak))
            throw_damaged(images_file,
                          fmt::format("channel {} of pixel {} of view \"{}\" is {}, {}", i % 3, i / 3, view.name, value,
                                      std::isfinite(value) ? "above its peak" : "not finite"));
    }
}

}  // namespace

uint64_t image_block_bytes(const View& view, Encoding encoding) {
    const uint64_t used = pixel_bytes(view.camera, encoding) + (view.mask_offset ? mask_bytes(view.camera) : 0);
    return (used + image_alignment - 1) / image_alignment * image_alignment;
}

uint64_t checked_bytes(const View& view, Encoding encoding) {
    return view.checksum ? image_block_bytes(view, encoding) : pixel_bytes(view.camera, encoding);
}

void check_image_bytes(const View& view, Encoding encoding, std::span<const uint8_t> bytes,
                       const fs::path& images_file) {
    if (view.checksum) {
        if (hash_bytes(bytes.data(), bytes.size()) != *view.checksum)
            throw_damaged(images_file, fmt::format("view \"{}\" is not as it was written: its checksum differs from "
                                                   "that in {}",
                                                   view.name, dataset_json_name));
        return;
    }
    if (encoding == Encoding::f16_linear)
        check_floats<uint16_t>(view, bytes, images_file, [](uint16_t h) { return float_from_half(h); });
    if (encoding == Encoding::f32_linear) check_floats<float>(view, bytes, images_file, [](float x) { return x; });
}

uint64_t file_checksum(const fs::path& file) {
    const InputFile in(file);
    std::vector<uint8_t> part(size_t(1) << 20);  // whole words, so that the parts' hash is the file's
    uint64_t hash = hash_bytes(nullptr, 0);
    for (uint64_t at = 0; at < in.size(); at += part.size()) {
        part.resize(std::min<uint64_t>(part.size(), in.size() - at));
        in.read(part.data(), at, part.size());
        hash = hash_bytes(part.data(), part.size(), hash);
    }
    return hash;
}

std::string dataset_checksum(const Dataset& dataset) {
    if (dataset.checksums.empty()) return "";
    return fmt::format("{:016x}", file_checksum(dataset.folder / dataset_json_name));
}

namespace {

/// A command with the last two names of each absolute path in it: a note that others read says nothing of the machine.
std::string without_places(const std::string& command) {
    std::istringstream words(command);
    std::string out;
    for (std::string word; words >> word;) {
        const fs::path path(word);
        if (path.is_absolute()) word = (path.parent_path().filename() / path.filename()).generic_string();
        out += (out.empty() ? "" : " ") + word;
    }
    return out;
}

}  // namespace

std::string dataset_note(const Dataset& dataset) {
    uint64_t bytes = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(dataset.folder))
        if (entry.is_regular_file() && entry.path().filename() != made_by_name) bytes += entry.file_size();
    const nlohmann::ordered_json note = {{"name", dataset.name},
                                         {"source", without_places(dataset.source)},
                                         {"checksum", dataset_checksum(dataset)},
                                         {"bytes", bytes}};
    return json_text(note, -1, NotUtf8::replace);
}

void check_file(const Dataset& dataset, const std::string& name) {
    const auto known = dataset.checksums.find(name);
    if (known == dataset.checksums.end()) return;
    const fs::path file = dataset.folder / name;
    std::error_code error;
    if (!fs::is_regular_file(file, error)) throw_damaged(file, "the file is missing or cannot be read");
    if (file_checksum(file) != known->second)
        throw_damaged(file, fmt::format("the file is not as it was written: its checksum differs from that in {}",
                                        dataset_json_name));
}

void check_pixels(const Dataset& dataset) {
    const fs::path images_file = dataset.folder / dataset_images_name;
    const InputFile file(images_file);
    std::vector<std::vector<uint8_t>> buffers{size_t(thread_count())};
    parallel_for(dataset.views.size(), 1, [&](size_t i, int worker) {
        const View& view = dataset.views[i];
        std::vector<uint8_t>& block = buffers[size_t(worker)];
        block.resize(checked_bytes(view, dataset.encoding));
        file.read(block.data(), view.pixel_offset, block.size());
        check_image_bytes(view, dataset.encoding, block, images_file);
    });
    if (has_truth(dataset)) read_truth(dataset.folder);  // sizes are compared before whole files are read
    for (const auto& [name, checksum] : dataset.checksums) check_file(dataset, name);
}

}  // namespace radiafit
