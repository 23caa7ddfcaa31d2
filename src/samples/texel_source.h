#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "samples/distributor.h"

/// Radiance samples grouped by texel: what solvers of texel-local models read, from memory or from disk.
namespace radiafit {

/// A pixel in a texel.
struct TexelRadiance {
    float value[3];  ///< linear RGB
    uint32_t image;  ///< position in the views that were distributed
};

/// Samples of neighbouring texels.
struct TexelSamples {
    std::vector<uint64_t> first;         ///< [texels + 1] into samples
    std::vector<TexelRadiance> samples;  ///< by texel, images ascending
    std::span<const TexelRadiance> of(size_t texel) const {
        return {samples.data() + first[texel], samples.data() + first[texel + 1]};
    }
};

class TexelSource {
public:
    virtual ~TexelSource() = default;
    /// Texels that are read at a time.
    static constexpr uint32_t block = 256;
    virtual uint32_t texel_count() const = 0;
    virtual uint64_t sample_count() const = 0;
    /// Texels [begin, min(begin + block, texel_count())); begin is a multiple of block. Thread-safe.
    virtual void read(uint32_t begin, TexelSamples& out) const = 0;
    size_t block_count() const { return (texel_count() + block - 1) / block; }
};

struct TexelDistributionOptions {
    /// Bytes of samples held at a time, beside those of the images in work (one per thread); what exceeds it waits in a
    /// file.
    uint64_t memory = ~uint64_t(0);
    std::string key = {};  ///< of records: what they come from; compared when they are opened again
};

struct TexelDistributionStatistics {
    uint64_t covered_pixels = 0, samples = 0;
    uint64_t bytes_written = 0;  ///< records and waiting samples
    uint64_t waiting_bytes = 0;
};

/// Distributes `views` in linear light, in memory. `workers` as for SampleCollector.
std::unique_ptr<TexelSource> gather_texels(const Dataset& dataset, const Atlas& atlas,
                                           const std::vector<uint32_t>& views, const std::vector<Distributor*>& workers,
                                           TexelDistributionStatistics& statistics);

/// Step 1 of the two-step baseline (Section 4.3): the same to texels.bin, texels_index.bin and texels.json in `folder`,
/// which must exist (docs/formats.md), in bounded memory. The bytes depend on neither memory nor threads. Throws
/// UserError if the disk is full or the folder not writable.
TexelDistributionStatistics write_texel_records(const std::filesystem::path& folder, const Dataset& dataset,
                                                const Atlas& atlas, const std::vector<uint32_t>& views,
                                                const std::vector<Distributor*>& workers,
                                                const TexelDistributionOptions& options);
/// Throws UserError if `folder` holds no whole records, damaged ones, or those of another key. Blocks are checked when
/// they are read.
std::unique_ptr<TexelSource> open_texel_records(const std::filesystem::path& folder, const std::string& key);
std::filesystem::path texel_records_file(const std::filesystem::path& folder);  ///< the large one

}  // namespace radiafit
