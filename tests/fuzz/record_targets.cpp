// Samples on disk. Checksums guard them; here they are put right, so that what lies behind them is met.
#include <nlohmann/json.hpp>

#include "base/hash.h"
#include "dataset_fixture.h"
#include "samples/block_file.h"
#include "samples/disk_records.h"
#include "samples/raster_distributor.h"
#include "samples/texel_source.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* key = "a key";

/// Gives a description the checksum that fits it.
void vouch(const fs::path& description) {
    const Json json = Json::parse(bytes_of(description), nullptr, false);
    if (json.is_object()) write_description(description, json.dump());
}

/// Gives it that of the index too.
void vouch(const fs::path& description, const fs::path& index) {
    Json json = Json::parse(bytes_of(description));
    const std::string bytes = bytes_of(index);
    json["index_checksum"] = hash_bytes(bytes.data(), bytes.size());
    write_description(description, json.dump());
}

/// `write` gets a dataset of small images.
void write_with(const fs::path& folder, const std::function<void(const Dataset&, const TriangleAtlas&)>& write) {
    write_random(folder / "set", Encoding::u8_srgb, {{9, 8, false, 1}, {7, 7, true, 1}});
    const Dataset dataset = open_dataset(folder / "set");
    write(dataset, TriangleAtlas(dataset.mesh, 3));
}

void write_vertices(const fs::path& folder) {
    write_with(folder, [&](const Dataset& dataset, const TriangleAtlas& atlas) {
        const auto workers = raster_distributors(atlas);
        write_records(folder, dataset, atlas, VertexRings(dataset.mesh), {0, 1}, worker_pointers(workers),
                      {.key = key});
    });
}

void write_texels(const fs::path& folder) {
    write_with(folder, [&](const Dataset& dataset, const TriangleAtlas& atlas) {
        const auto workers = raster_distributors(atlas);
        write_texel_records(folder, dataset, atlas, {0, 1}, worker_pointers(workers), ~uint64_t(0), key);
    });
}

void read_vertices(const fs::path& folder) {
    const DiskRecords records(folder, key);
    std::vector<uint8_t> blocks;
    for (size_t v = 0; v < records.vertex_count(); ++v) records.read(v, v + 1, blocks);
    if (records.vertex_count()) records.read(0, records.vertex_count(), blocks);
}

void read_texels(const fs::path& folder) {
    const auto source = open_texel_records(folder, key);
    TexelSamples samples;
    for (size_t b = 0; b < source->block_count(); ++b) source->read(uint32_t(b) * TexelSource::block, samples);
}

Target vertex_target(const char* name, const char* file, const std::function<void(const fs::path&)>& read) {
    const auto seeds = [=](const fs::path& folder) {
        write_vertices(folder);
        return std::vector<std::string>{bytes_of(folder / file)};
    };
    return {name, file, seeds, read};
}

Target texel_target(const char* name, const char* file, const std::function<void(const fs::path&)>& read) {
    const auto seeds = [=](const fs::path& folder) {
        write_texels(folder);
        return std::vector<std::string>{bytes_of(folder / file)};
    };
    return {name, file, seeds, read};
}

}  // namespace

std::vector<Target> record_targets() {
    const auto vertices = [](const fs::path& folder) {
        vouch(folder / "records.json");
        read_vertices(folder);
    };
    const auto vertices_of_index = [](const fs::path& folder) {
        vouch(folder / "records.json", folder / "index.bin");
        read_vertices(folder);
    };
    const auto texels = [](const fs::path& folder) {
        vouch(folder / "records.json");
        read_texels(folder);
    };
    const auto texels_of_index = [](const fs::path& folder) {
        vouch(folder / "records.json", folder / "index.bin");
        read_texels(folder);
    };
    return {vertex_target("records_json", "records.json", vertices),
            vertex_target("records_index", "index.bin", vertices_of_index),
            vertex_target("records", "records.bin", read_vertices),
            texel_target("texels_json", "records.json", texels),
            texel_target("texels_index", "index.bin", texels_of_index),
            texel_target("texels", "records.bin", read_texels)};
}

}  // namespace radiafit::fuzz
