#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "samples/block_file.h"
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
    static size_t texel_blocks(uint32_t texels) { return (size_t(texels) + block - 1) / block; }
    virtual uint32_t texel_count() const = 0;
    virtual uint64_t sample_count() const = 0;
    /// Texels [begin, min(begin + block, texel_count())); begin is a multiple of block. Thread-safe.
    virtual void read(uint32_t begin, TexelSamples& out) const = 0;
    size_t block_count() const { return texel_blocks(texel_count()); }
};

/// Distributes `views` in linear light, in memory. `workers` as for SampleCollector.
std::unique_ptr<TexelSource> gather_texels(const Dataset& dataset, const Atlas& atlas,
                                           const std::vector<uint32_t>& views,
                                           const std::vector<Distributor*>& workers);

/// Step 1 of the two-step baseline (Section 4.3): the same to a BlockFile in `folder`, which must exist. `memory`:
/// bytes of samples held at a time, beside those of the images in work (one per thread); what exceeds it waits in a
/// file. `key`: what they come from; compared when they are opened again. The bytes depend on neither memory nor
/// threads. Throws UserError if the disk is full or the folder not writable.
RecordStatistics write_texel_records(const std::filesystem::path& folder, const Dataset& dataset, const Atlas& atlas,
                                     const std::vector<uint32_t>& views, const std::vector<Distributor*>& workers,
                                     uint64_t memory, const std::string& key);
/// Throws UserError if `folder` holds no whole records, damaged ones, those of another key, or not of so many texels
/// and these dataset views. Blocks are checked when they are read.
std::unique_ptr<TexelSource> open_texel_records(const std::filesystem::path& folder, const std::string& key,
                                                uint32_t texels, const std::vector<uint32_t>& views);

}  // namespace radiafit
