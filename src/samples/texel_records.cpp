#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "samples/record_description.h"
#include "samples/texel_distribution.h"
#include "samples/whole_number.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* records_name = "texels.bin";
constexpr const char* index_name = "texels_index.bin";
constexpr const char* description_name = "texels.json";
constexpr const char* waiting_name = "waiting.bin";
constexpr const char* format = "radiafit-texel-records";

/// A sample on its way to its texel.
struct Entry {
    uint32_t texel;
    TexelRadiance radiance;
};

/// Samples as images leave them, in bins of neighbouring blocks; `memory` bytes at most are held, what exceeds them
/// waits in a file.
class Bins {
public:
    Bins(uint32_t blocks, uint64_t most_samples, uint64_t memory, fs::path file)
        : memory_(memory), path_(std::move(file)) {
        // a bin that comes back whole shall fit a quarter of the memory, unless texels crowd in it
        const uint64_t wanted = 1 + 8 * (most_samples * sizeof(Entry)) / memory;
        blocks_per_bin_ = std::max<uint32_t>(1, uint32_t(blocks / std::clamp<uint64_t>(wanted, 64, 4096)));
        bins_.resize((blocks + blocks_per_bin_ - 1) / blocks_per_bin_);
    }
    uint32_t count() const { return uint32_t(bins_.size()); }
    uint32_t blocks_per_bin() const { return blocks_per_bin_; }

    void add(std::span<const TakenTexels> images) {
        parallel_for(bins_.size(), 4, [&](size_t bin, int) {
            const size_t begin = bin * blocks_per_bin_, end = begin + blocks_per_bin_;
            for (const TakenTexels& image : images) {
                const uint32_t last = image.first[std::min(end, image.first.size() - 1)];
                for (uint32_t k = image.first[begin]; k < last; ++k)
                    bins_[bin].held.push_back({image.texels[k], image.radiance(k)});
            }
        });
        for (const TakenTexels& image : images) held_ += image.count() * sizeof(Entry);
        if (held_ > memory_ / 2) spill();
    }
    void close() {
        if (!out_) return;
        out_->close();
        in_.emplace(path_);
    }
    uint64_t waiting_bytes() const { return out_ ? out_->bytes() : 0; }
    /// In the order in which they were added; only once. Thread-safe for different bins.
    std::vector<Entry> take(uint32_t bin) {
        Bin& b = bins_[bin];
        std::vector<Entry> out;
        uint64_t waiting = 0;
        for (const Part& part : b.waiting) waiting += part.count;
        out.resize(waiting);
        Entry* to = out.data();
        for (const Part& part : b.waiting) {
            in_->read(to, part.offset, part.count * sizeof(Entry));
            to += part.count;
        }
        if (out.empty()) return std::exchange(b.held, {});
        out.insert(out.end(), b.held.begin(), b.held.end());
        b.held = {};
        return out;
    }

private:
    struct Part {
        uint64_t offset, count;
    };
    struct Bin {
        std::vector<Entry> held;
        std::vector<Part> waiting;
    };
    void spill() {
        if (!out_) out_.emplace(path_);
        for (Bin& bin : bins_) {
            if (bin.held.empty()) continue;
            bin.waiting.push_back({out_->bytes(), bin.held.size()});
            out_->write(bin.held.data(), bin.held.size() * sizeof(Entry));
            bin.held = {};
        }
        held_ = 0;
    }

    uint64_t memory_, held_ = 0;
    fs::path path_;
    uint32_t blocks_per_bin_ = 1;
    std::vector<Bin> bins_;
    std::optional<OutputFile> out_;
    std::optional<InputFile> in_;
};

/// Calls take(block, samples) for the blocks of one bin.
template <class Take>
void sort_bin(Bins& bins, uint32_t bin, uint32_t texels, const Take& take) {
    const std::vector<Entry> entries = bins.take(bin);
    const uint32_t first_block = bin * bins.blocks_per_bin(), begin = first_block * TexelSource::block;
    const uint32_t end = std::min(begin + bins.blocks_per_bin() * TexelSource::block, texels);
    std::vector<uint32_t> counts(end - begin, 0);
    for (const Entry& e : entries) ++counts[e.texel - begin];
    std::vector<TexelSamples> blocks;
    std::vector<TexelRadiance*> next(counts.size());
    for (uint32_t texel = begin; texel < end; texel += TexelSource::block) {
        TexelSamples& block = blocks.emplace_back();
        const uint32_t size = std::min(TexelSource::block, end - texel);
        block.first.assign(size + 1, 0);
        for (uint32_t t = 0; t < size; ++t) block.first[t + 1] = block.first[t] + counts[texel - begin + t];
        block.samples.resize(block.first.back());
        for (uint32_t t = 0; t < size; ++t) next[texel - begin + t] = block.samples.data() + block.first[t];
    }
    for (const Entry& e : entries) *next[e.texel - begin]++ = e.radiance;
    for (uint32_t k = 0; k < blocks.size(); ++k) take(first_block + k, std::move(blocks[k]));
}

uint64_t pixels_of(const Dataset& dataset, const std::vector<uint32_t>& views) {
    uint64_t pixels = 0;
    for (const uint32_t view : views)
        pixels += uint64_t(dataset.views[view].camera.width) * uint64_t(dataset.views[view].camera.height);
    return pixels;
}

/// Of a block on disk: `first`, then samples.
struct BlockRecord {
    uint64_t offset, samples, checksum;
};
uint64_t checksum_of(const TexelSamples& block) {
    const uint64_t first = hash_bytes(block.first.data(), block.first.size() * sizeof(uint64_t));
    return hash_bytes(block.samples.data(), block.samples.size() * sizeof(TexelRadiance), first);
}

class TexelsOnDisk final : public TexelSource {
public:
    TexelsOnDisk(const fs::path& folder, const std::string& key)
        : path_(folder / records_name), file_(open_records_file(path_)) {
        const fs::path description_path = folder / description_name, index_path = folder / index_name;
        const Json description = Json::parse(read_description(description_path, format, key));
        const InputFile index = open_records_file(index_path);
        try {
            const auto texels = whole_number(description.at("texels"));
            if (!texels) throw_damaged_records(description_path);
            texels_ = *texels;
            if (index.size() != texel_blocks(texels_) * sizeof(BlockRecord)) throw_damaged_records(index_path);
            blocks_.resize(texel_blocks(texels_));
            index.read(blocks_.data(), 0, index.size());
            if (description.at("index_checksum") != hash_bytes(blocks_.data(), index.size()))
                throw_damaged_records(index_path);
            for (const BlockRecord& record : blocks_) samples_ += record.samples;
            if (description.at("samples") != samples_) throw_damaged_records(description_path);
            if (file_.size() != description.at("bytes")) throw_damaged_records(path_);
        } catch (const Json::exception&) {
            throw_damaged_records(description_path);
        }
        for (size_t b = 0; b < blocks_.size(); ++b)
            if (!stands_in_file(b)) throw_damaged_records(index_path);
    }
    uint32_t texel_count() const override { return texels_; }
    uint64_t sample_count() const override { return samples_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        const BlockRecord& record = blocks_[begin / block];
        const uint64_t head = head_bytes(begin);
        out.first.resize(head / sizeof(uint64_t));
        out.samples.resize(record.samples);
        file_.read(out.first.data(), record.offset, head);
        file_.read(out.samples.data(), record.offset + head, record.samples * sizeof(TexelRadiance));
        if (checksum_of(out) != record.checksum) throw_damaged_records(path_);
    }

private:
    uint64_t head_bytes(uint32_t begin) const { return (std::min(block, texels_ - begin) + 1) * sizeof(uint64_t); }
    bool stands_in_file(size_t b) const {
        const uint64_t bytes = file_.size(), offset = blocks_[b].offset, head = head_bytes(uint32_t(b) * block);
        return offset <= bytes && head <= bytes - offset &&
               blocks_[b].samples <= (bytes - offset - head) / sizeof(TexelRadiance);
    }

    uint32_t texels_ = 0;
    uint64_t samples_ = 0;
    std::vector<BlockRecord> blocks_;
    fs::path path_;
    InputFile file_;
};

}  // namespace

TexelDistributionStatistics write_texel_records(const fs::path& folder, const Dataset& dataset, const Atlas& atlas,
                                                const std::vector<uint32_t>& views,
                                                const std::vector<Distributor*>& workers,
                                                const TexelDistributionOptions& options) {
    TexelDistributionStatistics statistics;
    const uint32_t texels = atlas.texel_count();
    Bins bins(texel_blocks(texels), pixels_of(dataset, views), options.memory, folder / waiting_name);
    distribute_views(dataset, views, workers, statistics,
                     [&](std::span<const TakenTexels> images) { bins.add(images); });
    bins.close();
    OutputFile out(folder / records_name);
    std::vector<BlockRecord> index(texel_blocks(texels));
    for (uint32_t bin = 0; bin < bins.count(); ++bin)
        sort_bin(bins, bin, texels, [&](uint32_t block, const TexelSamples& samples) {
            index[block] = {out.bytes(), samples.samples.size(), checksum_of(samples)};
            out.write(samples.first.data(), samples.first.size() * sizeof(uint64_t));
            out.write(samples.samples.data(), samples.samples.size() * sizeof(TexelRadiance));
        });
    out.close();
    OutputFile index_file(folder / index_name);
    index_file.write(index.data(), index.size() * sizeof(BlockRecord));
    index_file.close();
    statistics.waiting_bytes = bins.waiting_bytes();
    statistics.bytes_written = out.bytes() + index_file.bytes() + statistics.waiting_bytes;
    if (statistics.waiting_bytes) fs::remove(folder / waiting_name);
    const nlohmann::ordered_json description = {
        {"format", format},
        {"version", 1},
        {"texels", texels},
        {"samples", statistics.samples},
        {"bytes", out.bytes()},
        {"views", views},
        {"index_checksum", hash_bytes(index.data(), index.size() * sizeof(BlockRecord))},
        {"key", options.key}};
    write_description(folder / description_name, description.dump());
    return statistics;
}

std::unique_ptr<TexelSource> open_texel_records(const fs::path& folder, const std::string& key) {
    return std::make_unique<TexelsOnDisk>(folder, key);
}

fs::path texel_records_file(const fs::path& folder) { return folder / records_name; }

}  // namespace radiafit
