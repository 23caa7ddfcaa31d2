#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/file.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "samples/distributor.h"

/// Step 1 of the CPU baseline (Sections 4.3 and 6.2): radiance samples distributed to disk, so that each vertex's
/// problem reads back in one piece. Samples of a vertex stand by (image, ring position, texel); every sample stands
/// three times, once for each corner of its triangle. Layout of the files: docs/formats.md.
namespace radiafit {

enum class RecordKind {
    compact,  ///< stored channels and the place in the vertex's maps: 4 to 10 bytes a sample and vertex
    full      ///< the paper's: target, residual, surface-map coordinate, three view-map coordinates; 56 bytes
};

struct RecordOptions {
    RecordKind kind = RecordKind::compact;
    TargetSpace space = TargetSpace::stored;
    uint64_t memory = uint64_t(1) << 30;  ///< bytes of samples held at a time; what exceeds it waits in files
    std::string key = {};                 ///< what the records come from; compared when they are opened again
};

/// A vertex's problem in the file.
struct VertexRecord {
    uint64_t offset = 0;       ///< bytes, into records.bin
    uint32_t images = 0;       ///< groups: images that see its ring
    uint32_t samples = 0;      ///< radiance samples: pixels in the ring's texels
    float mean[3] = {};        ///< of the targets L t
    uint32_t texel_bytes = 1;  ///< compact: size of a place in the maps
    uint64_t checksum = 0;     ///< of its block
};

struct RecordStatistics {
    uint64_t bytes_written = 0;  ///< records and waiting files
    uint64_t bytes_read = 0;     ///< of waiting files
    uint64_t waiting_parts = 0;  ///< ranges of images whose samples waited on disk
    uint64_t covered_pixels = 0, samples = 0;
};

/// Distributes `views` into `folder`, which must exist. `workers` as for SampleCollector. The bytes do not depend on
/// memory, distributor threads or thread count. Throws UserError if the disk is full or the folder not writable.
RecordStatistics write_records(const std::filesystem::path& folder, const Dataset& dataset, const TriangleAtlas& atlas,
                               const VertexRings& rings, const std::vector<uint32_t>& views,
                               std::vector<Distributor*> workers, const RecordOptions& options);

/// Records on disk. Reading is thread-safe.
class DiskRecords {
public:
    /// Throws UserError if `folder` holds no whole records, damaged ones, or records of another key. Blocks are checked
    /// when they are read.
    DiskRecords(const std::filesystem::path& folder, const std::string& key);

    /// Throws UserError unless they are of so many vertices and of these dataset views: whoever looks either up by an
    /// index of the records asks first.
    void require(size_t vertices, const std::vector<uint32_t>& views) const;

    RecordKind kind() const { return kind_; }
    int bits() const { return bits_; }      ///< compact: of a stored channel
    float scale() const { return scale_; }  ///< compact: target per unit of a 16-bit channel (8 bits: times 257)
    const std::vector<uint32_t>& views() const { return views_; }  ///< dataset views of the images
    size_t vertex_count() const { return vertices_.size(); }
    const VertexRecord& vertex(size_t v) const { return vertices_[v]; }
    uint64_t block_bytes(size_t v) const { return end(v) - vertices_[v].offset; }
    uint64_t bytes() const { return bytes_; }
    static std::filesystem::path file(const std::filesystem::path& folder);  ///< the large one

    /// Blocks of vertices [begin, end), one after another. Throws UserError if one isn't what was written.
    void read(size_t begin, size_t end, std::vector<uint8_t>& blocks) const;

private:
    bool holds_its_samples(size_t v) const;
    uint64_t end(size_t v) const { return v + 1 < vertices_.size() ? vertices_[v + 1].offset : bytes_; }

    RecordKind kind_;
    int bits_;
    float scale_;
    uint64_t bytes_;
    std::vector<uint32_t> views_;
    std::vector<VertexRecord> vertices_;
    InputFile file_;
    std::filesystem::path path_;
};

/// Header of a group in a block: all groups' headers first, then all samples.
struct RecordGroup {
    uint32_t image;  ///< position in views()
    uint32_t samples;
};

/// One sample as the paper writes it out.
struct FullRecord {
    float target[3];
    float residual[3];  ///< of the empty model: -L t
    float surface[2];   ///< x = ring position + (column + 1/2) / n, y = (row + 1/2) / n of the texel's cell
    float view[3][2];   ///< in the view maps of the triangle's corners; the vertex's own first
};

}  // namespace radiafit
