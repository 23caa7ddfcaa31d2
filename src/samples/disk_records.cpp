#include "samples/disk_records.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/hash.h"
#include "base/parallel.h"
#include "model/lfm.h"
#include "samples/image_samples.h"
#include "samples/record_description.h"
#include "samples/whole_number.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

constexpr const char* records_name = "records.bin";
constexpr const char* index_name = "index.bin";
constexpr const char* description_name = "records.json";
constexpr const char* waiting_name = "waiting.bin";
constexpr const char* format = "radiafit-records";

using Json = nlohmann::ordered_json;

RecordKind kind_of(const Json& name) {
    if (name == "full") return RecordKind::full;
    if (name == "compact") return RecordKind::compact;
    throw Json::other_error::create(501, "no kind of records", nullptr);
}
int bits_of(const Json& bits) {
    if (bits == 8) return 8;
    if (bits == 16) return 16;
    throw Json::other_error::create(501, "no bits", nullptr);
}

uint64_t index_checksum(const std::vector<VertexRecord>& index) {
    return hash_bytes(index.data(), index.size() * sizeof(VertexRecord));
}
template <class T>
void append(std::vector<uint8_t>& out, const T* from, size_t count) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(from);
    out.insert(out.end(), bytes, bytes + count * sizeof(T));
}

/// What tiles took from a range of images, by tile: where step 1 puts samples until their vertices' turn comes. A
/// tile's part is a row of [RecordGroup][Sample...], images ascending.
class TileStore {
public:
    /// In memory, or behind what `out` holds already.
    TileStore(const std::vector<ImageSamples>& images, uint32_t first_image, uint32_t tiles, OutputFile* out)
        : on_disk_(out), begin_(out ? out->bytes() : 0) {
        std::vector<uint32_t> next(images.size(), 0);  // run of each image
        std::vector<uint8_t> part;
        offsets_.push_back(0);
        for (uint32_t tile = 0; tile < tiles; ++tile) {
            part.clear();
            for (size_t k = 0; k < images.size(); ++k) {
                const ImageSamples::Run* run = &images[k].runs[next[k]];
                if (run->tile != tile) continue;
                ++next[k];
                const RecordGroup group{first_image + uint32_t(k), run[1].first - run[0].first};
                append(part, &group, 1);
                append(part, images[k].samples.data() + run->first, group.samples);
            }
            offsets_.push_back(offsets_.back() + part.size());
            out ? out->write(part.data(), part.size()) : append(memory_, part.data(), part.size());
        }
    }
    uint64_t bytes() const { return offsets_.back(); }
    uint64_t tile_bytes(uint32_t tile) const { return offsets_[tile + 1] - offsets_[tile]; }
    /// `file`: what was written to `out`.
    void append_tile(uint32_t tile, const std::optional<InputFile>& file, std::vector<uint8_t>& out) const {
        if (!on_disk_) return append(out, memory_.data() + offsets_[tile], tile_bytes(tile));
        out.resize(out.size() + tile_bytes(tile));
        file->read(out.data() + out.size() - tile_bytes(tile), begin_ + offsets_[tile], tile_bytes(tile));
    }

private:
    bool on_disk_;
    uint64_t begin_;
    std::vector<uint64_t> offsets_;  ///< [tiles + 1]
    std::vector<uint8_t> memory_;
};

/// All stores, and the one file that those on disk share.
struct TileStores {
    std::vector<TileStore> parts;
    std::optional<InputFile> file;

    void append_tile(uint32_t tile, std::vector<uint8_t>& out, size_t part) const {
        parts[part].append_tile(tile, file, out);
    }
    uint64_t tile_bytes(uint32_t tile) const {
        uint64_t bytes = 0;
        for (const TileStore& part : parts) bytes += part.tile_bytes(tile);
        return bytes;
    }
};

/// Writes blocks of vertices from what the stores hold of their rings' tiles.
class BlockWriter {
public:
    BlockWriter(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                const std::vector<uint32_t>& views, const RecordOptions& options, int bits, float scale)
        : atlas_(&atlas),
          rings_(&rings),
          kind_(options.kind),
          bits_(bits),
          scale_(scale),
          frames_(vertex_frames(atlas.mesh())) {
        for (uint32_t view : views) centers_.push_back(dataset.views[view].camera.center());
    }

    void block(size_t v, const TileStores& stores, std::vector<uint8_t>& out, VertexRecord& record) const {
        std::vector<uint8_t> tiles;
        std::vector<Part> parts;
        const auto ring = rings_->ring(v);
        for (uint32_t position = 0; position < ring.size(); ++position)
            for (size_t part = 0; part < stores.parts.size(); ++part) {
                stores.append_tile(ring[position].triangle, tiles, part);
                find_parts(position, tiles, parts);
            }
        std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
            return std::pair(a.image, a.position) < std::pair(b.image, b.position);
        });
        record = {};
        const uint64_t places = uint64_t(ring.size()) * atlas_->texels_per_tile();
        record.texel_bytes = places <= 0x100 ? 1 : places <= 0x10000 ? 2 : 4;
        out.clear();
        for (size_t i = 0; i < parts.size();) {
            RecordGroup group{parts[i].image, 0};
            for (; i < parts.size() && parts[i].image == group.image; ++i) group.samples += parts[i].samples;
            append(out, &group, 1);
            ++record.images;
            record.samples += group.samples;
        }
        double sum[3] = {};
        for (const Part& part : parts) samples(v, part, tiles.data() + part.at, out, record, sum);
        for (int c = 0; c < 3 && record.samples; ++c) record.mean[c] = float(sum[c] / record.samples);
        record.checksum = hash_bytes(out.data(), out.size());
    }

private:
    struct Part {
        uint32_t image, position, samples;
        size_t at;  ///< of the first sample
    };
    /// Finds the groups between what `parts` know already and the end of `tiles`.
    static void find_parts(uint32_t position, const std::vector<uint8_t>& tiles, std::vector<Part>& parts) {
        size_t at = parts.empty() ? 0 : parts.back().at + parts.back().samples * sizeof(Sample);
        while (at < tiles.size()) {
            RecordGroup group;
            std::memcpy(&group, tiles.data() + at, sizeof group);
            at += sizeof group;
            parts.push_back({group.image, position, group.samples, at});
            at += group.samples * sizeof(Sample);
        }
    }
    void samples(size_t v, const Part& part, const uint8_t* from, std::vector<uint8_t>& out, const VertexRecord& record,
                 double sum[3]) const {
        const Corner& corner = rings_->ring(v)[part.position];
        FullRecord full{};
        if (kind_ == RecordKind::full) {
            const auto& triangle = atlas_->mesh().triangles[corner.triangle];
            for (uint32_t j = 0; j < 3; ++j) {
                const uint32_t vertex = triangle[(corner.corner + j) % 3];
                const auto xy =
                    view_coordinate(frames_[vertex], atlas_->mesh().positions[vertex], centers_[part.image]);
                for (size_t i = 0; i < 2; ++i) full.view[j][i] = float(xy[i]);
            }
        }
        for (uint32_t i = 0; i < part.samples; ++i) {
            Sample sample;
            std::memcpy(&sample, from + i * sizeof sample, sizeof sample);
            const float weight = atlas_->barycentric(sample.local)[corner.corner];
            for (int c = 0; c < 3; ++c) sum[c] += double(weight * scale_) * sample.rgb[c];
            if (kind_ == RecordKind::full) {
                const auto [column, row] = atlas_->cell(sample.local);
                const float n = float(atlas_->side());
                full.surface[0] = float(part.position) + (float(column) + 0.5f) / n;
                full.surface[1] = (float(row) + 0.5f) / n;
                for (int c = 0; c < 3; ++c) {
                    full.target[c] = scale_ * float(sample.rgb[c]);
                    full.residual[c] = -weight * full.target[c];
                }
                append(out, &full, 1);
                continue;
            }
            if (bits_ == 8)
                for (uint16_t channel : sample.rgb) out.push_back(uint8_t(channel / 257));
            else
                append(out, sample.rgb, 3);
            const uint32_t place = part.position * atlas_->texels_per_tile() + sample.local;
            append(out, reinterpret_cast<const uint8_t*>(&place), record.texel_bytes);  // little endian
        }
    }

    const TriangleAtlas* atlas_;
    const VertexRings* rings_;
    RecordKind kind_;
    int bits_;
    float scale_;
    std::vector<Frame> frames_;
    std::vector<Vec3d> centers_;
};

uint64_t bytes_of(const ImageSamples& image) {
    return image.samples.size() * sizeof(Sample) + image.runs.size() * sizeof(ImageSamples::Run);
}

/// First loop: images in, tiles out. Holds at most half of the memory in images; the other half is a store's.
TileStores store_tiles(const fs::path& folder, SampleCollector& collector, const std::vector<uint32_t>& views,
                       uint32_t tiles, uint64_t memory, RecordStatistics& statistics) {
    TileStores stores;
    std::optional<OutputFile> file;
    std::vector<ImageSamples> waiting;
    uint64_t bytes = 0;
    uint32_t first = 0;
    const auto store = [&](bool to_disk) {
        if (to_disk && !file) file.emplace(folder / waiting_name);
        stores.parts.emplace_back(waiting, first, tiles, to_disk ? &*file : nullptr);
        statistics.waiting_parts += to_disk;
        first += uint32_t(waiting.size());
        waiting.clear();
        bytes = 0;
    };
    std::vector<ImageSamples> batch(size_t(collector.at_once()));
    for (size_t k = 0; k < views.size(); k += batch.size()) {
        const size_t count = std::min(batch.size(), views.size() - k);
        collector.collect({views.data() + k, count}, batch);
        for (size_t i = 0; i < count; ++i) {
            statistics.covered_pixels += batch[i].covered_pixels;
            statistics.samples += batch[i].samples.size();
            bytes += bytes_of(batch[i]);
            waiting.push_back(std::move(batch[i]));
        }
        if (bytes > memory / 2) store(true);
    }
    if (!waiting.empty()) store(!stores.parts.empty());
    if (file) {
        statistics.bytes_written += file->bytes();
        file->close();
        stores.file.emplace(folder / waiting_name);
    }
    return stores;
}

}  // namespace

RecordStatistics write_records(const fs::path& folder, const Dataset& dataset, const TriangleAtlas& atlas,
                               const VertexRings& rings, const std::vector<uint32_t>& views,
                               std::vector<Distributor*> workers, const RecordOptions& options) {
    RecordStatistics statistics;
    SampleCollector collector(dataset, atlas, std::move(workers), options.space);
    const TileStores stores = store_tiles(folder, collector, views, atlas.tile_count(), options.memory, statistics);

    const BlockWriter writer(dataset, atlas, rings, views, options, collector.bits(), collector.scale());
    OutputFile out(folder / records_name);
    std::vector<VertexRecord> index(rings.vertex_count());
    const uint64_t expansion = options.kind == RecordKind::full ? sizeof(FullRecord) / sizeof(Sample) : 1;
    const auto ring_bytes = [&](size_t v) {
        uint64_t bytes = 0;
        for (const Corner& corner : rings.ring(v)) bytes += stores.tile_bytes(corner.triangle);
        return bytes;
    };
    std::vector<std::vector<uint8_t>> blocks;
    for (size_t begin = 0, end = 0; begin < index.size(); begin = end) {
        // as many vertices at a time as a quarter of the memory holds, and their tiles
        for (uint64_t bytes = 0; end < index.size() && end - begin < 256; ++end) {
            bytes += (1 + expansion) * ring_bytes(end);
            if (end > begin && bytes > options.memory / 4) break;
        }
        blocks.resize(std::max(blocks.size(), end - begin));
        parallel_for(end - begin, 4,
                     [&](size_t i, int) { writer.block(begin + i, stores, blocks[i], index[begin + i]); });
        for (size_t v = begin; v < end; ++v) {
            index[v].offset = out.bytes();
            out.write(blocks[v - begin].data(), blocks[v - begin].size());
            if (stores.file) statistics.bytes_read += ring_bytes(v);
        }
    }
    out.close();
    OutputFile index_file(folder / index_name);
    index_file.write(index.data(), index.size() * sizeof(VertexRecord));
    index_file.close();
    statistics.bytes_written += out.bytes() + index_file.bytes();
    if (stores.file) fs::remove(folder / waiting_name);
    nlohmann::ordered_json description = {{"format", format},
                                          {"version", 1},
                                          {"kind", options.kind == RecordKind::full ? "full" : "compact"},
                                          {"vertices", index.size()},
                                          {"bytes", out.bytes()},
                                          {"bits", collector.bits()},
                                          {"scale", collector.scale()},
                                          {"views", views},
                                          {"index_checksum", index_checksum(index)},
                                          {"key", options.key}};
    write_description(folder / description_name, description.dump());
    return statistics;
}

DiskRecords::DiskRecords(const fs::path& folder, const std::string& key)
    : file_((read_description(folder / description_name, format, key), open_records_file(folder / records_name))),
      path_(folder / records_name) {
    const fs::path description = folder / description_name, index_path = folder / index_name;
    const Json json = Json::parse(read_description(description, format, key));
    bytes_ = file_.size();
    const InputFile index = open_records_file(index_path);
    try {
        if (index.size() % sizeof(VertexRecord) != 0 || json.at("vertices") != index.size() / sizeof(VertexRecord))
            throw_damaged_records(index_path);
        vertices_.resize(index.size() / sizeof(VertexRecord));
        index.read(vertices_.data(), 0, index.size());
        kind_ = kind_of(json.at("kind"));
        bits_ = bits_of(json.at("bits"));
        scale_ = json.at("scale").get<float>();
        if (!(scale_ > 0 && std::isfinite(scale_))) throw_damaged_records(description);
        if (!json.at("views").is_array()) throw_damaged_records(description);
        for (const Json& view : json.at("views")) {
            const auto index = whole_number(view);
            if (!index) throw_damaged_records(description);
            views_.push_back(*index);
        }
        if (json.at("bytes") != bytes_) throw_damaged_records(path_);
        if (json.at("index_checksum") != index_checksum(vertices_)) throw_damaged_records(index_path);
    } catch (const Json::exception&) {
        throw_damaged_records(description);
    }
    for (size_t v = 0; v < vertices_.size(); ++v)
        if (!holds_its_samples(v)) throw_damaged_records(index_path);
}

bool DiskRecords::holds_its_samples(size_t v) const {
    const VertexRecord& record = vertices_[v];
    if (record.offset > end(v) || end(v) > bytes_) return false;
    const uint32_t place = record.texel_bytes;
    const uint64_t compact = uint64_t(bits_) * 3 / 8 + place;
    return (place == 1 || place == 2 || place == 4) &&
           block_bytes(v) == record.images * sizeof(RecordGroup) +
                                 record.samples * (kind_ == RecordKind::full ? sizeof(FullRecord) : compact);
}

void DiskRecords::require(size_t vertices, const std::vector<uint32_t>& views) const {
    if (vertices_.size() != vertices || views_ != views) throw_damaged_records(path_.parent_path() / description_name);
}

fs::path DiskRecords::file(const fs::path& folder) { return folder / records_name; }

void DiskRecords::read(size_t begin, size_t end, std::vector<uint8_t>& blocks) const {
    const uint64_t from = vertices_[begin].offset, to = this->end(end - 1);
    blocks.resize(to - from);
    file_.read(blocks.data(), from, to - from);
    const uint8_t* block = blocks.data();
    for (size_t v = begin; v < end; block += block_bytes(v), ++v)
        if (hash_bytes(block, block_bytes(v)) != vertices_[v].checksum) throw_damaged_records(path_);
}

}  // namespace radiafit
