// Samples on disk. Checksums guard them; here they are put right, so that what lies behind them is met.
#include <nlohmann/json.hpp>
#include <stdexcept>

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
void vouch_for_description(const fs::path& folder) {
    const Json json = Json::parse(bytes_of(folder / "records.json"), nullptr, false);
    if (json.is_object()) write_description(folder / "records.json", json.dump());
}

/// Gives it that of the index too.
void vouch_for_index(const fs::path& folder) {
    Json json = Json::parse(bytes_of(folder / "records.json"));
    const std::string bytes = bytes_of(folder / "index.bin");
    json["index_checksum"] = hash_bytes(bytes.data(), bytes.size());
    write_description(folder / "records.json", json.dump());
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
    static const uint32_t texels = TriangleAtlas(open_dataset(folder / "set").mesh, 3).texel_count();
    const auto source = open_texel_records(folder, key, texels, {0, 1});
    TexelSamples samples;
    uint64_t images = 0;
    for (size_t b = 0; b < source->block_count(); ++b) {
        source->read(uint32_t(b) * TexelSource::block, samples);
        for (size_t t = 0; t + 1 < samples.first.size(); ++t)
            for (const TexelRadiance& s : samples.of(t)) images += s.image;
    }
    if (images > source->sample_count()) throw std::logic_error("an image that is none");
}

using Step = void (*)(const fs::path&);

/// The three files that `write` leaves and `read` takes.
std::vector<Target> targets_of(const std::string& name, Step write, Step read) {
    const auto target = [=](const char* suffix, const char* file, Step vouch) {
        const auto seeds = [=](const fs::path& folder) {
            write(folder);
            return std::vector<std::string>{bytes_of(folder / file)};
        };
        const auto vouch_and_read = [=](const fs::path& folder) {
            if (vouch) vouch(folder);
            read(folder);
        };
        return Target{name + suffix, file, seeds, vouch_and_read};
    };
    return {target("_json", "records.json", vouch_for_description), target("_index", "index.bin", vouch_for_index),
            target("", "records.bin", nullptr)};
}

}  // namespace

std::vector<Target> record_targets() {
    std::vector<Target> all = targets_of("records", write_vertices, read_vertices);
    for (Target& target : targets_of("texels", write_texels, read_texels)) all.push_back(std::move(target));
    return all;
}

}  // namespace radiafit::fuzz
