#include "samples/disk_records.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/json.h"
#include "model/lfm.h"
#include "samples/image_samples.h"
#include "samples/whole_number.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
static_assert(sizeof(RecordGroup) == sizeof(Sample));

uint64_t bytes_of_sample(RecordKind kind, int bits, uint32_t texel_bytes) {
    return kind == RecordKind::full ? sizeof(FullRecord) : uint64_t(bits) * 3 / 8 + texel_bytes;
}

/// Makes blocks of vertices from what waits for the tiles of their rings: by image, a RecordGroup and its samples.
class BlockMaker {
public:
    BlockMaker(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
               const std::vector<uint32_t>& views, const RecordOptions& options, int bits, float scale)
        : atlas_(&atlas),
          rings_(&rings),
          kind_(options.kind),
          bits_(bits),
          scale_(scale),
          frames_(vertex_frames(atlas.mesh())) {
        for (uint32_t view : views) centers_.push_back(dataset.views[view].camera.center());
    }

    void make(size_t v, const WaitingItems<Sample>& tiles, std::vector<uint8_t>& out, VertexRecord& record) const {
        std::vector<Sample> waiting;
        std::vector<Part> parts;
        const auto ring = rings_->ring(v);
        for (uint32_t position = 0; position < ring.size(); ++position) {
            tiles.get(ring[position].triangle, waiting);
            find_parts(position, waiting, parts);
        }
        std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
            return std::pair(a.image, a.position) < std::pair(b.image, b.position);
        });
        std::vector<uint32_t> first_texels;  // of the ring's maps
        uint32_t places = 0;
        for (const Corner& corner : ring) {
            first_texels.push_back(places);
            places += atlas_->tile(corner.triangle).texels();
        }
        record.texel_bytes = places <= 0x100 ? 1 : places <= 0x10000 ? 2 : 4;
        for (size_t i = 0; i < parts.size();) {
            RecordGroup group{parts[i].image, 0};
            for (; i < parts.size() && parts[i].image == group.image; ++i) group.samples += parts[i].samples;
            append_bytes<RecordGroup>(out, {&group, 1});
            ++record.images;
            record.samples += group.samples;
        }
        out.reserve(out.size() + record.samples * bytes_of_sample(kind_, bits_, record.texel_bytes));
        double sum[3] = {};
        for (const Part& part : parts)
            append_samples(v, part, first_texels[part.position], {waiting.data() + part.at, part.samples}, out, record,
                           sum);
        for (int c = 0; c < 3 && record.samples; ++c) record.mean[c] = float(sum[c] / record.samples);
    }

private:
    struct Part {
        uint32_t image, position, samples;
        size_t at;  ///< of the first sample
    };
    /// Finds the groups between what `parts` know already and the end of `waiting`.
    static void find_parts(uint32_t position, std::span<const Sample> waiting, std::vector<Part>& parts) {
        size_t at = parts.empty() ? 0 : parts.back().at + parts.back().samples;
        while (at < waiting.size()) {
            const auto group = std::bit_cast<RecordGroup>(waiting[at++]);
            parts.push_back({group.image, position, group.samples, at});
            at += group.samples;
        }
    }
    void append_samples(size_t v, const Part& part, uint32_t first_texel, std::span<const Sample> samples,
                        std::vector<uint8_t>& out, const VertexRecord& record, double sum[3]) const {
        const Corner& corner = rings_->ring(v)[part.position];
        const TriangleTile& tile = atlas_->tile(corner.triangle);
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
        for (const Sample& sample : samples) {
            const float weight = tile.barycentric(sample.local)[corner.corner];
            for (int c = 0; c < 3; ++c) sum[c] += double(weight * scale_) * sample.rgb[c];
            if (kind_ == RecordKind::full) {
                const auto [column, row] = tile.cell(sample.local);
                const float n = float(tile.side());
                full.surface[0] = float(part.position) + (float(column) + 0.5f) / n;
                full.surface[1] = (float(row) + 0.5f) / n;
                for (int c = 0; c < 3; ++c) {
                    full.target[c] = scale_ * float(sample.rgb[c]);
                    full.residual[c] = -weight * full.target[c];
                }
                append_bytes<FullRecord>(out, {&full, 1});
                continue;
            }
            if (bits_ == 8)
                for (uint16_t channel : sample.rgb) out.push_back(uint8_t(channel / 257));
            else
                append_bytes<uint16_t>(out, sample.rgb);
            const uint32_t place = first_texel + sample.local;
            append_bytes<uint8_t>(out,
                                  {reinterpret_cast<const uint8_t*>(&place), record.texel_bytes});  // little endian
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

}  // namespace

RecordStatistics write_records(const fs::path& folder, const Dataset& dataset, const TriangleAtlas& atlas,
                               const VertexRings& rings, const std::vector<uint32_t>& views,
                               std::vector<Distributor*> workers, const RecordOptions& options) {
    SampleCollector collector(dataset, atlas.texels_per_tile(), std::move(workers), options.space);
    return write_records(folder, dataset, atlas, rings, views, collector, options);
}

RecordStatistics write_records(const fs::path& folder, const Dataset& dataset, const TriangleAtlas& atlas,
                               const VertexRings& rings, const std::vector<uint32_t>& views, TileSampler& sampler,
                               const RecordOptions& options) {
    WaitingItems<Sample> tiles(atlas.tile_count(), options.memory / 2, folder);
    collect_by_block(sampler, views, tiles, [&](uint32_t image, size_t tile, std::span<const Sample> samples) {
        const auto group = std::bit_cast<Sample>(RecordGroup{image, uint32_t(samples.size())});
        tiles.add(tile, {&group, 1});
        tiles.add(tile, samples);
    });

    const BlockMaker maker(dataset, atlas, rings, views, options, sampler.bits(), sampler.scale());
    BlockFileWriter out(folder);
    std::vector<VertexRecord> records(rings.vertex_count());
    const auto held = [&](size_t v) {
        const uint64_t expansion = options.kind == RecordKind::full ? sizeof(FullRecord) / sizeof(Sample) : 2;
        uint64_t bytes = 0;
        for (const Corner& corner : rings.ring(v)) bytes += tiles.bytes(corner.triangle);
        return (1 + expansion) * bytes;
    };
    out.append_all(records.size(), options.memory / 4, held,
                   [&](size_t v, std::vector<uint8_t>& block) { maker.make(v, tiles, block, records[v]); });
    tiles.remove_file();
    std::vector<uint8_t> table;
    append_bytes<VertexRecord>(table, records);
    out.append(table, hash_bytes(table.data(), table.size()));
    const Json description = {{"kind", options.kind == RecordKind::full ? "full" : "compact"},
                              {"bits", sampler.bits()},
                              {"scale", sampler.scale()},
                              {"views", views}};
    const uint64_t bytes = out.close(options.key, json_text(description));
    return {bytes + tiles.bytes_written(), tiles.bytes_read(), tiles.spills()};
}

DiskRecords::DiskRecords(const fs::path& folder, const std::string& key) : file_(folder, key) {
    Json json = parse_json<Json>(file_.description());
    kind_ = json["kind"] == "full" ? RecordKind::full : RecordKind::compact;
    file_.require_description(kind_ == RecordKind::full || json["kind"] == "compact");
    bits_ = json["bits"] == 8 ? 8 : 16;
    file_.require_description(bits_ == 8 || json["bits"] == 16);
    file_.require_description(json["scale"].is_number() && json["views"].is_array());
    scale_ = json["scale"].get<float>();
    file_.require_description(scale_ > 0 && std::isfinite(scale_));
    for (const Json& view : json["views"]) {
        const auto index = whole_number(view);
        file_.require_description(index.has_value());
        views_.push_back(*index);
    }
    file_.require_index(file_.size() > 0);
    std::vector<uint8_t> table;
    file_.read(file_.size() - 1, file_.size(), table);
    vertices_.resize(file_.size() - 1);
    file_.require_index(table.size() == vertices_.size() * sizeof(VertexRecord));
    if (!table.empty()) std::memcpy(vertices_.data(), table.data(), table.size());
    for (size_t v = 0; v < vertices_.size(); ++v) {
        const auto& [images, samples, mean, place] = vertices_[v];
        file_.require_index(place == 1 || place == 2 || place == 4);
        file_.require_index(block_bytes(v) ==
                            images * sizeof(RecordGroup) + samples * bytes_of_sample(kind_, bits_, place));
    }
}

void DiskRecords::require(size_t vertices, const std::vector<uint32_t>& views) const {
    file_.require_description(vertices_.size() == vertices && views_ == views);
}

}  // namespace radiafit
