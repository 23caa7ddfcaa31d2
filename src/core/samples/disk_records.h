#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "samples/block_file.h"
#include "samples/distributor.h"
#include "samples/record_options.h"

/// Step 1 of the CPU baseline (Sections 4.3 and 6.2): radiance samples distributed to disk, so that each vertex's
/// problem reads back in one piece. Samples of a vertex are ordered by (image, ring position, texel); every sample is
/// stored three times, once for each corner of its triangle. Layout of the files: docs/formats.md.
namespace radiafit {

class TileSampler;  // samples/image_samples.h

/// What the last block says of each vertex's problem; vertex v's samples are block v.
struct VertexRecord {
    uint32_t images = 0;       ///< groups: images that see its ring
    uint32_t samples = 0;      ///< radiance samples: pixels in the ring's texels
    float mean[3] = {};        ///< of the targets L t
    uint32_t texel_bytes = 1;  ///< compact: size of a place in the maps
};

/// Distributes `views` into `folder`, which must exist. `workers` as for SampleCollector. The bytes do not depend on
/// memory, distributor threads or thread count. Throws UserError if the disk is full or the folder not writable.
RecordStatistics write_records(const std::filesystem::path& folder, const Dataset& dataset, const TriangleAtlas& atlas,
                               const VertexRings& rings, const std::vector<uint32_t>& views,
                               std::vector<Distributor*> workers, const RecordOptions& options);
/// The same for the samples that `sampler` finds in the atlas's tiles, in the space of the options.
RecordStatistics write_records(const std::filesystem::path& folder, const Dataset& dataset, const TriangleAtlas& atlas,
                               const VertexRings& rings, const std::vector<uint32_t>& views, TileSampler& sampler,
                               const RecordOptions& options);

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
    uint64_t block_bytes(size_t v) const { return file_.block_bytes(v); }

    /// Blocks of vertices [begin, end), one after another. Throws UserError if one isn't what was written.
    void read(size_t begin, size_t end, std::vector<uint8_t>& blocks) const { file_.read(begin, end, blocks); }

private:
    BlockFile file_;
    RecordKind kind_;
    int bits_;
    float scale_;
    std::vector<uint32_t> views_;
    std::vector<VertexRecord> vertices_;
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
    float surface[2];   ///< x = ring position + (column + 1/2) / n, y = (row + 1/2) / n of the texel's cell, n its
                        ///< tile's side
    float view[3][2];   ///< in the view maps of the triangle's corners; that of the record's vertex first
};

}  // namespace radiafit
