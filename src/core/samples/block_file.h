#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/hash.h"

/// Blocks of bytes in a folder: records.bin has them one after another, index.bin where each begins and its checksum,
/// and records.json says what they are and come from, and that all three are whole (docs/formats.md).
namespace radiafit {

/// Step 1 of a two-step fit: what it wrote and read.
struct RecordStatistics {
    uint64_t bytes_written = 0;  ///< index, blocks and samples that waited on disk
    uint64_t bytes_read = 0;     ///< of samples that waited on disk
    uint64_t waiting_parts = 0;  ///< times that memory was full and samples went to disk
};

/// A line of the index.
struct BlockEntry {
    uint64_t offset;    ///< where the block begins, and the one before ends
    uint64_t checksum;  ///< hash_bytes() of it
};

template <class T>
void append_bytes(std::vector<uint8_t>& out, std::span<const T> values) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(values.data());
    out.insert(out.end(), bytes, bytes + values.size_bytes());
}

/// Throws UserError if the disk is full or the folder not writable.
class BlockFileWriter {
public:
    explicit BlockFileWriter(const std::filesystem::path& folder);
    /// `checksum`: hash_bytes() of the block.
    void append(std::span<const uint8_t> block, uint64_t checksum);
    /// Appends `count` blocks. make(b, block) fills an empty one, for several b at a time; `held(b)` is how many bytes
    /// it holds meanwhile, and all that work at a time hold `memory` bytes at most, unless one alone holds more.
    void append_all(size_t count, uint64_t memory, const std::function<uint64_t(size_t b)>& held,
                    const std::function<void(size_t b, std::vector<uint8_t>& block)>& make);
    /// `key`: what the blocks come from. `more`: a JSON object of what else the description shall say. Returns the
    /// bytes of blocks and index.
    uint64_t close(const std::string& key, const std::string& more);

private:
    std::filesystem::path folder_;
    OutputFile blocks_;
    std::vector<BlockEntry> index_;
};

/// Reading is thread-safe.
class BlockFile {
public:
    /// Throws UserError if `folder` holds no whole blocks, damaged ones, or those of another key. Blocks are checked
    /// when they are read.
    BlockFile(const std::filesystem::path& folder, const std::string& key);

    const std::string& description() const { return description_; }  ///< a JSON object
    size_t size() const { return index_.size() - 1; }
    uint64_t block_bytes(size_t b) const { return index_[b + 1].offset - index_[b].offset; }
    /// Blocks [begin, end), one after another. Throws UserError if one isn't what was written.
    void read(size_t begin, size_t end, std::vector<uint8_t>& out) const;
    /// For what only those know who wrote the blocks. Throw UserError, that the description, the index or the blocks
    /// are damaged, unless they say what they must.
    void require_description(bool whole) const;
    void require_index(bool whole) const;
    void require_blocks(bool whole) const;

    static std::filesystem::path file(const std::filesystem::path& folder);  ///< of the blocks, the large one

private:
    std::filesystem::path folder_;
    std::string description_;
    InputFile blocks_;
    std::vector<BlockEntry> index_;  ///< and one more, where the last block ends
};

/// Adds a checksum to a JSON object and writes the file.
void write_description(const std::filesystem::path& file, const std::string& object);

}  // namespace radiafit
