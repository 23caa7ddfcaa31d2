#include "samples/texel_source.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "samples/record_description.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

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

/// Samples as images leave them, in bins of neighbouring blocks; in memory, or waiting in a file.
class Bins {
public:
    /// `memory` bytes at most are held; without a file, all.
    Bins(uint32_t blocks, uint64_t most_samples, uint64_t memory, fs::path file)
        : memory_(memory), path_(std::move(file)) {
        // a bin that comes back whole shall fit a quarter of the memory, unless texels crowd in it
        const uint64_t wanted = 1 + 8 * (most_samples * sizeof(Entry)) / memory;
        blocks_per_bin_ = std::max<uint32_t>(1, uint32_t(blocks / std::clamp<uint64_t>(wanted, 64, 4096)));
        bins_.resize((blocks + blocks_per_bin_ - 1) / blocks_per_bin_);
    }
    uint32_t count() const { return uint32_t(bins_.size()); }
    uint32_t blocks_per_bin() const { return blocks_per_bin_; }

    /// Texels ascending.
    void add(const std::vector<Entry>& entries) {
        for (auto begin = entries.begin(); begin != entries.end();) {
            const uint32_t bin = begin->texel / TexelSource::block / blocks_per_bin_;
            const uint64_t end_texel = uint64_t(bin + 1) * blocks_per_bin_ * TexelSource::block;
            const auto end = std::lower_bound(begin, entries.end(), end_texel,
                                              [](const Entry& e, uint64_t texel) { return e.texel < texel; });
            bins_[bin].held.insert(bins_[bin].held.end(), begin, end);
            held_ += uint64_t(end - begin) * sizeof(Entry);
            begin = end;
        }
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

/// Streams images, several at a time, into bins, in order.
void distribute(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                const std::vector<Distributor*>& distributors, Bins& bins, TexelDistributionStatistics& statistics) {
    if (distributors.empty()) throw std::invalid_argument("distribute: no distributor");
    if (distributors.size() > 1 && distributors.size() < size_t(thread_count()))
        throw std::invalid_argument("distribute: fewer distributors than threads");
    struct Worker {
        ImageStream stream;
        TargetImage image;
        std::vector<float> values;
        Distribution distribution;
    };
    std::vector<Worker> workers;
    const size_t at_once = distributors.size() == 1 ? 1 : size_t(thread_count());
    for (size_t i = 0; i < at_once; ++i)
        workers.push_back({ImageStream(dataset, StreamSource::disk, TargetSpace::linear), {}, {}, {}});
    std::vector<std::vector<Entry>> entries(at_once);
    std::vector<uint32_t> covered(entries.size());
    for (size_t begin = 0; begin < views.size(); begin += entries.size()) {
        const size_t count = std::min(entries.size(), views.size() - begin);
        const auto one = [&](size_t i, int worker) {
            auto& [stream, image, values, distribution] = workers[size_t(worker)];
            const uint32_t view = views[begin + i];
            stream.load(view, image);  // for the mask; values unrounded come below
            stream.load_values(view, values);
            distributors[size_t(worker)]->distribute(dataset.views[view].camera, image, distribution);
            covered[i] = distribution.covered_pixels;
            entries[i].clear();
            for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
                const uint32_t pixel = distribution.texel_pixel[texel];
                if (pixel == no_pixel) continue;
                const float* v = values.data() + 3 * size_t(pixel);
                entries[i].push_back({texel, {{v[0], v[1], v[2]}, uint32_t(begin + i)}});
            }
        };
        if (at_once == 1)
            for (size_t i = 0; i < count; ++i) one(i, 0);
        else
            parallel_for(count, 1, one);
        for (size_t i = 0; i < count; ++i) {
            bins.add(entries[i]);
            statistics.covered_pixels += covered[i];
            statistics.samples += entries[i].size();
        }
    }
    bins.close();
}

/// The samples of one block from entries of its texels.
TexelSamples sorted(std::span<const Entry> entries, uint32_t begin, uint32_t end) {
    TexelSamples out;
    out.first.assign(end - begin + 1, 0);
    for (const Entry& e : entries) ++out.first[e.texel - begin + 1];
    for (size_t t = 1; t < out.first.size(); ++t) out.first[t] += out.first[t - 1];
    std::vector<uint64_t> next(out.first.begin(), out.first.end() - 1);
    out.samples.resize(entries.size());
    for (const Entry& e : entries) out.samples[next[e.texel - begin]++] = e.radiance;
    return out;
}

/// Calls take(block, samples) for the blocks of one bin.
template <class Take>
void sort_bin(Bins& bins, uint32_t bin, uint32_t texels, const Take& take) {
    std::vector<Entry> entries = bins.take(bin);
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return a.texel / TexelSource::block < b.texel / TexelSource::block;
    });
    auto at = entries.begin();
    for (uint32_t k = 0; k < bins.blocks_per_bin(); ++k) {
        const uint32_t block = bin * bins.blocks_per_bin() + k, begin = block * TexelSource::block;
        if (begin >= texels) break;
        const uint32_t end = std::min(begin + TexelSource::block, texels);
        const auto last =
            std::lower_bound(at, entries.end(), end, [](const Entry& e, uint32_t texel) { return e.texel < texel; });
        take(block, sorted({at, last}, begin, end));
        at = last;
    }
}

uint64_t pixels_of(const Dataset& dataset, const std::vector<uint32_t>& views) {
    uint64_t pixels = 0;
    for (const uint32_t view : views)
        pixels += uint64_t(dataset.views[view].camera.width) * uint64_t(dataset.views[view].camera.height);
    return pixels;
}
uint32_t blocks_of(uint32_t texels) { return (texels + TexelSource::block - 1) / TexelSource::block; }

class TexelsInMemory final : public TexelSource {
public:
    TexelsInMemory(uint32_t texels, uint64_t samples)
        : texels_(texels), samples_(samples), blocks_(blocks_of(texels)) {}
    uint32_t texel_count() const override { return texels_; }
    uint64_t sample_count() const override { return samples_; }
    void read(uint32_t begin, TexelSamples& out) const override { out = blocks_[begin / block]; }
    void put(uint32_t block, TexelSamples samples) { blocks_[block] = std::move(samples); }

private:
    uint32_t texels_;
    uint64_t samples_;
    std::vector<TexelSamples> blocks_;
};

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
    TexelsOnDisk(const fs::path& folder, const nlohmann::ordered_json& description)
        : texels_(description.at("texels")),
          samples_(description.at("samples")),
          blocks_(blocks_of(texels_)),
          path_(folder / records_name),
          file_(open_records_file(path_)) {
        const InputFile index = open_records_file(folder / index_name);
        if (index.size() != blocks_.size() * sizeof(BlockRecord)) throw_damaged_records(folder / index_name);
        index.read(blocks_.data(), 0, index.size());
        if (description.at("index_checksum") != hash_bytes(blocks_.data(), index.size()))
            throw_damaged_records(folder / index_name);
        if (file_.size() != description.at("bytes")) throw_damaged_records(path_);
    }
    uint32_t texel_count() const override { return texels_; }
    uint64_t sample_count() const override { return samples_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        const BlockRecord& record = blocks_[begin / block];
        out.first.resize(std::min(block, texels_ - begin) + 1);
        out.samples.resize(record.samples);
        const uint64_t head = out.first.size() * sizeof(uint64_t);
        file_.read(out.first.data(), record.offset, head);
        file_.read(out.samples.data(), record.offset + head, record.samples * sizeof(TexelRadiance));
        if (checksum_of(out) != record.checksum) throw_damaged_records(path_);
    }

private:
    uint32_t texels_;
    uint64_t samples_;
    std::vector<BlockRecord> blocks_;
    fs::path path_;
    InputFile file_;
};

}  // namespace

std::unique_ptr<TexelSource> gather_texels(const Dataset& dataset, const Atlas& atlas,
                                           const std::vector<uint32_t>& views, std::vector<Distributor*> workers,
                                           TexelDistributionStatistics& statistics) {
    const uint32_t texels = atlas.texel_count();
    Bins bins(blocks_of(texels), pixels_of(dataset, views), ~uint64_t(0), {});
    distribute(dataset, atlas, views, workers, bins, statistics);
    auto out = std::make_unique<TexelsInMemory>(texels, statistics.samples);
    parallel_for(bins.count(), 1, [&](size_t bin, int) {
        sort_bin(bins, uint32_t(bin), texels,
                 [&](uint32_t block, TexelSamples samples) { out->put(block, std::move(samples)); });
    });
    return out;
}

TexelDistributionStatistics write_texel_records(const fs::path& folder, const Dataset& dataset, const Atlas& atlas,
                                                const std::vector<uint32_t>& views, std::vector<Distributor*> workers,
                                                const TexelDistributionOptions& options) {
    TexelDistributionStatistics statistics;
    const uint32_t texels = atlas.texel_count();
    Bins bins(blocks_of(texels), pixels_of(dataset, views), options.memory, folder / waiting_name);
    distribute(dataset, atlas, views, workers, bins, statistics);
    OutputFile out(folder / records_name);
    std::vector<BlockRecord> index(blocks_of(texels));
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
    return std::make_unique<TexelsOnDisk>(
        folder, nlohmann::ordered_json::parse(read_description(folder / description_name, format, key)));
}

fs::path texel_records_file(const fs::path& folder) { return folder / records_name; }

}  // namespace radiafit
