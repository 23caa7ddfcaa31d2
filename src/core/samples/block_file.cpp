#include "samples/block_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "base/wording.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr const char* description_name = "records.json";
constexpr const char* index_name = "index.bin";
constexpr const char* blocks_name = "records.bin";
constexpr const char* format = "radiafit-records";
constexpr int version = 2;

/// The checksum of everything but the checksum itself.
uint64_t checksum_of(Json description) {
    description.erase("checksum");
    const std::string text = json_text(description);
    return hash_bytes(text.data(), text.size());
}
uint64_t checksum_of(const std::vector<BlockEntry>& index) {
    return hash_bytes(index.data(), index.size() * sizeof(BlockEntry));
}

[[noreturn]] void throw_damaged(const fs::path& file) {
    throw UserError(fmt::format("{}: {}; delete the folder {}, it is made anew", file.string(),
                                path_exists(file) ? "damaged" : "missing", file.parent_path().string()));
}

InputFile open_file(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) throw_damaged(file);
    return InputFile(file);
}

bool says(const Json& json, const char* name, const Json& value) {
    return json.is_object() && json.contains(name) && json.at(name) == value;
}

std::string read_description(const fs::path& file, const std::string& key) {
    std::string text;
    if (path_exists(file)) text = read_file(file, "description of records");
    if (nested_deeper(text, 100)) throw_damaged(file);
    const Json json = parse_json<Json>(text);
    if (says(json, "format", format) && !says(json, "version", version))
        throw UserError(fmt::format("{}: records of another version; delete the folder {}, it is made anew",
                                    file.string(), file.parent_path().string()));
    if (!says(json, "format", format))
        throw UserError(
            fmt::format("{}: holds no whole records; choose another {} folder", file.string(), option_name("records")));
    if (!says(json, "checksum", checksum_of(json))) throw_damaged(file);
    if (!says(json, "key", key))
        throw UserError(fmt::format("{}: records of another dataset or of other options; choose another {} folder",
                                    file.string(), option_name("records")));
    return json_text(json);
}

}  // namespace

BlockFileWriter::BlockFileWriter(const fs::path& folder) : folder_(folder), blocks_(folder / blocks_name) {}

void BlockFileWriter::append(std::span<const uint8_t> block, uint64_t checksum) {
    index_.push_back({blocks_.bytes(), checksum});
    blocks_.write(block.data(), block.size());
}

void BlockFileWriter::append_all(size_t count, uint64_t memory, const std::function<uint64_t(size_t b)>& held,
                                 const std::function<void(size_t b, std::vector<uint8_t>& block)>& make) {
    memory = std::min(memory, uint64_t(32) << 20);  // more is no faster: the memory would be new for every block
    for (size_t begin = 0, end = 0; begin < count; begin = end) {
        for (uint64_t bytes = 0; end < count && end - begin < 256; ++end) {
            bytes += held(end);
            if (end > begin && bytes > memory) break;
        }
        std::vector<std::vector<uint8_t>> blocks(end - begin);
        std::vector<uint64_t> checksums(end - begin);
        parallel_for(blocks.size(), 1, [&](size_t i, int) {
            make(begin + i, blocks[i]);
            checksums[i] = hash_bytes(blocks[i].data(), blocks[i].size());
        });
        for (size_t i = 0; i < blocks.size(); ++i) append(blocks[i], checksums[i]);
    }
}

uint64_t BlockFileWriter::close(const std::string& key, const std::string& more) {
    blocks_.close();
    OutputFile index(folder_ / index_name);
    index.write(index_.data(), index_.size() * sizeof(BlockEntry));
    index.close();
    Json description = {{"format", format}, {"version", version}, {"key", key}};
    description.update(parse_json<Json>(more));
    description["bytes"] = blocks_.bytes();
    description["index_checksum"] = checksum_of(index_);
    write_description(folder_ / description_name, json_text(description));
    return blocks_.bytes() + index.bytes();
}

BlockFile::BlockFile(const fs::path& folder, const std::string& key)
    : folder_(folder),
      description_(read_description(folder / description_name, key)),
      blocks_(open_file(folder / blocks_name)) {
    const InputFile index = open_file(folder / index_name);
    index_.resize(index.size() / sizeof(BlockEntry));
    index.read(index_.data(), 0, index_.size() * sizeof(BlockEntry));
    const Json description = parse_json<Json>(description_);
    require_index(index.size() % sizeof(BlockEntry) == 0 && says(description, "index_checksum", checksum_of(index_)));
    const uint64_t bytes = blocks_.size();
    if (!says(description, "bytes", bytes)) throw_damaged(folder / blocks_name);
    index_.push_back({bytes, 0});
    for (size_t b = 0; b < size(); ++b) require_index(index_[b].offset <= index_[b + 1].offset);
}

void BlockFile::read(size_t begin, size_t end, std::vector<uint8_t>& out) const {
    out.resize(index_[end].offset - index_[begin].offset);
    blocks_.read(out.data(), index_[begin].offset, out.size());
    const uint8_t* block = out.data();
    for (size_t b = begin; b < end; block += block_bytes(b), ++b)
        if (hash_bytes(block, block_bytes(b)) != index_[b].checksum) throw_damaged(folder_ / blocks_name);
}

void BlockFile::require_description(bool whole) const {
    if (!whole) throw_damaged(folder_ / description_name);
}

void BlockFile::require_index(bool whole) const {
    if (!whole) throw_damaged(folder_ / index_name);
}

void BlockFile::require_blocks(bool whole) const {
    if (!whole) throw_damaged(folder_ / blocks_name);
}

fs::path BlockFile::file(const fs::path& folder) { return folder / blocks_name; }

void write_description(const fs::path& file, const std::string& object) {
    Json description = parse_json<Json>(object);
    description["checksum"] = checksum_of(description);
    write_file(file, json_text(description, 1) + "\n");
}

}  // namespace radiafit
