#include "samples/texel_source.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/json.h"
#include "samples/image_samples.h"
#include "samples/whole_number.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Samples as images left them, by block; brought into their texels' order whenever they are read.
class GatheredTexels final : public TexelSource {
public:
    /// Samples that exceed `memory` bytes wait in `folder`.
    GatheredTexels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                   const std::vector<Distributor*>& workers, uint64_t memory = ~uint64_t(0),
                   const fs::path& folder = {})
        : texels_(atlas.texel_count()), blocks_(texel_blocks(texels_), memory, folder) {
        if (views.size() > ~uint32_t(0) / block) throw std::invalid_argument("GatheredTexels: too many views");
        SampleCollector collector(dataset, block, workers, TargetSpace::linear);
        collect_by_block(collector, views, blocks_,
                         [&](uint32_t, size_t b, std::span<const LinearSample> samples) { blocks_.add(b, samples); });
        for (size_t b = 0; b < blocks_.keys(); ++b) samples_ += blocks_.bytes(b) / sizeof(LinearSample);
    }

    uint32_t texel_count() const override { return texels_; }
    uint64_t sample_count() const override { return samples_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        std::vector<LinearSample> waiting;
        blocks_.get(begin / block, waiting);
        out.first.assign(std::min(block, texels_ - begin) + 1, 0);
        for (const LinearSample& s : waiting) ++out.first[s.place % block + 1];
        for (size_t t = 1; t < out.first.size(); ++t) out.first[t] += out.first[t - 1];
        std::array<uint64_t, block> next;
        std::copy_n(out.first.begin(), out.first.size() - 1, next.begin());
        out.samples.resize(waiting.size());
        for (const LinearSample& s : waiting)
            out.samples[next[s.place % block]++] = {{s.rgb[0], s.rgb[1], s.rgb[2]}, s.place / block};
    }
    WaitingItems<LinearSample>& blocks() { return blocks_; }

private:
    uint32_t texels_;
    uint64_t samples_ = 0;
    WaitingItems<LinearSample> blocks_;
};

/// A block on disk: `first`, then samples.
class TexelsOnDisk final : public TexelSource {
public:
    TexelsOnDisk(const fs::path& folder, const std::string& key, uint32_t texels, const std::vector<uint32_t>& views)
        : file_(folder, key), texels_(texels), views_(views.size()) {
        Json description = parse_json<Json>(file_.description());
        file_.require_description(description["kind"] == "texels" && description["texels"] == texels &&
                                  description["views"] == views);
        file_.require_index(file_.size() == block_count());
        for (size_t b = 0; b < file_.size(); ++b) {
            const uint64_t bytes = file_.block_bytes(b), head = head_bytes(b);
            file_.require_index(bytes >= head && (bytes - head) % sizeof(TexelRadiance) == 0);
            samples_ += (bytes - head) / sizeof(TexelRadiance);
        }
    }
    uint32_t texel_count() const override { return texels_; }
    uint64_t sample_count() const override { return samples_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        const size_t b = begin / block, head = head_bytes(b);
        std::vector<uint8_t> bytes;
        file_.read(b, b + 1, bytes);
        out.first.resize(head / sizeof(uint64_t));
        out.samples.resize((bytes.size() - head) / sizeof(TexelRadiance));
        std::memcpy(out.first.data(), bytes.data(), head);
        if (!out.samples.empty()) std::memcpy(out.samples.data(), bytes.data() + head, bytes.size() - head);
        file_.require_blocks(out.first.front() == 0 && out.first.back() == out.samples.size() &&
                             std::is_sorted(out.first.begin(), out.first.end()) &&
                             std::all_of(out.samples.begin(), out.samples.end(),
                                         [&](const TexelRadiance& s) { return s.image < views_; }));
    }

private:
    size_t head_bytes(size_t b) const {
        return (std::min(block, texels_ - uint32_t(b) * block) + 1) * sizeof(uint64_t);
    }

    BlockFile file_;
    uint32_t texels_;
    size_t views_;
    uint64_t samples_ = 0;
};

}  // namespace

std::unique_ptr<TexelSource> gather_texels(const Dataset& dataset, const Atlas& atlas,
                                           const std::vector<uint32_t>& views,
                                           const std::vector<Distributor*>& workers) {
    return std::make_unique<GatheredTexels>(dataset, atlas, views, workers);
}

RecordStatistics write_texel_records(const fs::path& folder, const Dataset& dataset, const Atlas& atlas,
                                     const std::vector<uint32_t>& views, const std::vector<Distributor*>& workers,
                                     uint64_t memory, const std::string& key) {
    GatheredTexels gathered(dataset, atlas, views, workers, memory / 2, folder);
    WaitingItems<LinearSample>& waiting = gathered.blocks();
    BlockFileWriter out(folder);
    // a block's bytes as they waited, in their texels' order, and as they are written
    const auto held = [&](size_t b) { return 3 * waiting.bytes(b); };
    out.append_all(gathered.block_count(), memory / 4, held, [&](size_t b, std::vector<uint8_t>& block) {
        TexelSamples samples;
        gathered.read(uint32_t(b) * TexelSource::block, samples);
        append_bytes<uint64_t>(block, samples.first);
        append_bytes<TexelRadiance>(block, samples.samples);
    });
    waiting.remove_file();
    const Json description = {{"kind", "texels"}, {"texels", gathered.texel_count()}, {"views", views}};
    const uint64_t bytes = out.close(key, json_text(description));
    return {bytes + waiting.bytes_written(), waiting.bytes_read(), waiting.spills()};
}

std::unique_ptr<TexelSource> open_texel_records(const fs::path& folder, const std::string& key, uint32_t texels,
                                                const std::vector<uint32_t>& views) {
    return std::make_unique<TexelsOnDisk>(folder, key, texels, views);
}

}  // namespace radiafit
