#pragma once
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/file.h"
#include "base/interrupt.h"

/// What long work has finished, kept on disk as it goes on: work in independent blocks, each with a number, of which a
/// run that was stopped does not do again those that are kept (docs/reliability.md, docs/formats.md).
namespace radiafit {

/// A file of finished blocks, written at its end only. Each has a checksum: of a file that was cut, or has rotted, the
/// blocks before the first damage count. A disk that takes no more ends the keeping, with a warning, and not the work.
class Journal {
public:
    /// Opens what is there, or makes it once there is something to keep. `key`: all that decides what the blocks are.
    /// Writes every `seconds`; 0: nothing. Throws UserError for a file of another key, or none of this kind.
    Journal(std::filesystem::path file, std::string key, double seconds);

    const std::filesystem::path& file() const { return file_; }
    size_t kept() const;  ///< blocks, those of earlier runs among them
    /// A block that an earlier run kept. Thread-safe, as keep() is.
    std::optional<std::string> find(uint64_t block) const;
    void keep(uint64_t block, std::string_view bytes);
    /// Writes now what is kept.
    void flush();

    /// The key of a file; none where it is damaged or of another kind.
    static std::optional<std::string> key_of(const std::filesystem::path& file);

private:
    struct Place {
        uint64_t offset, size;
    };
    void read_blocks();
    void write_waiting();

    std::filesystem::path file_;
    std::string key_;
    double seconds_, written_s_;  ///< between writes; of the last one
    std::optional<InputFile> in_;
    uint64_t end_ = 0;               ///< of what is whole in the file; 0: there is none yet
    std::map<uint64_t, Place> old_;  ///< by block
    mutable std::mutex mutex_;
    std::string waiting_;
    size_t kept_ = 0;
    bool given_up_ = false;
};

/// work(), which a signal (interrupt.h) ends with the journal written.
template <class Work>
auto keeping(Journal& journal, const Work& work) {
    try {
        return work();
    } catch (const Interrupted&) {
        journal.flush();
        throw;
    }
}

/// A number, or a struct of numbers.
template <class T>
concept PlainField = std::is_trivially_copyable_v<T> && !requires(T t) {
    t.size_bytes();
};

/// A block's fields, one after another, into bytes.
class BlockWriter {
public:
    template <PlainField T>
    void operator()(const T& value) {
        append(&value, sizeof value);
    }
    template <class T>
    void operator()(std::span<T> values) {
        append(values.data(), values.size_bytes());
    }
    template <class T>
    void operator()(const std::vector<T>& values) {
        (*this)(uint64_t(values.size()));
        (*this)(std::span(values));
    }
    const std::string& bytes() const { return bytes_; }

private:
    void append(const void* from, size_t bytes) { bytes_.append(static_cast<const char*>(from), bytes); }
    std::string bytes_;
};

/// The same fields back from them. Throws UserError where the block has another size.
class BlockReader {
public:
    BlockReader(const std::string& bytes, const std::filesystem::path& file) : left_(bytes), file_(&file) {}
    template <PlainField T>
    void operator()(T& value) {
        take(&value, sizeof value);
    }
    template <class T>
    void operator()(std::span<T> values) {
        take(values.data(), values.size_bytes());
    }
    template <class T>
    void operator()(std::vector<T>& values) {
        uint64_t count = 0;
        (*this)(count);
        if (count > left_.size() / sizeof(T)) throw_damaged();
        values.resize(count);
        (*this)(std::span(values));
    }
    void finish() const {
        if (!left_.empty()) throw_damaged();
    }

private:
    void take(void* to, size_t bytes) {
        if (bytes > left_.size()) throw_damaged();
        std::memcpy(to, left_.data(), bytes);
        left_.remove_prefix(bytes);
    }
    [[noreturn]] void throw_damaged() const;

    std::string_view left_;
    const std::filesystem::path* file_;
};

/// What a block of work leaves, `fields(visit)`, which hands each field to visit: from the journal where it is there;
/// else work() makes it, and the journal, if any, keeps it.
template <class Fields, class Work>
void once(Journal* journal, uint64_t block, const Fields& fields, const Work& work) {
    if (!journal) return work();
    if (const auto bytes = journal->find(block)) {
        BlockReader reader(*bytes, journal->file());
        fields(reader);
        return reader.finish();
    }
    work();
    BlockWriter writer;
    fields(writer);
    journal->keep(block, writer.bytes());
}

}  // namespace radiafit
