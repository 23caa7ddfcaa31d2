#pragma once
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/parallel.h"

/// What long work has finished, kept on disk as it goes on: work in stages of independent blocks, of which a run that
/// was stopped does not do again those that are kept (docs/reliability.md, docs/formats.md).
namespace radiafit {

/// A file of finished blocks, written at its end only. Each has a checksum, which the key enters: of a file that was
/// cut, or has rotted, the blocks before the first damage count, and of one with another key none. A disk that takes no
/// more ends the keeping, with a warning, and not the work.
class Journal {
public:
    /// Opens what is there, or makes it once there is something to keep. `key`: a line with all that decides what the
    /// blocks are. Writes every `seconds`; 0: nothing.
    Journal(std::filesystem::path file, const std::string& key, double seconds);

    const std::filesystem::path& file() const { return file_; }
    /// Stages have numbers in the order in which they begin, which the key decides, too.
    uint64_t begin_stage() { return stages_++; }
    /// A block that an earlier run kept. Thread-safe, as keep() is.
    std::optional<std::string> find(uint64_t stage, uint64_t block) const;
    void keep(uint64_t stage, uint64_t block, std::string_view bytes);
    /// Writes now what is kept.
    void flush();

    /// The first line of a file: its key, if it is a journal.
    static std::string key_of(const std::filesystem::path& file);

private:
    struct Place {
        uint64_t offset, size;
    };
    void read_blocks();
    void write_waiting();

    std::filesystem::path file_;
    std::string head_;            ///< the key as the file's first line
    double seconds_, written_s_;  ///< between writes; of the last one
    std::optional<InputFile> in_;
    uint64_t end_ = 0;  ///< of what is whole in the file
    uint64_t stages_ = 0;
    std::map<std::pair<uint64_t, uint64_t>, Place> old_;  ///< by stage and block
    std::mutex mutex_;
    std::string waiting_;
    bool given_up_ = false;
};

/// A block's fields, one after another, into bytes: numbers or structs of numbers, spans and vectors of them.
class BlockWriter {
public:
    template <class T>
    void operator()(std::span<T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    }
    template <class T>
    void operator()(const std::vector<T>& values) {
        const uint64_t count = values.size();
        (*this)(std::span(&count, 1));
        (*this)(std::span(values));
    }
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

/// The same fields back from them. Throws UserError, naming the file, where the block has another size.
class BlockReader {
public:
    BlockReader(std::string_view bytes, const std::filesystem::path& file) : left_(bytes), file_(&file) {}
    template <class T>
    void operator()(std::span<T> values) {
        if (values.size_bytes() > left_.size()) throw_other_size();
        std::memcpy(values.data(), left_.data(), values.size_bytes());
        left_.remove_prefix(values.size_bytes());
    }
    template <class T>
    void operator()(std::vector<T>& values) {
        uint64_t count = 0;
        (*this)(std::span(&count, 1));
        if (count > left_.size() / sizeof(T)) throw_other_size();
        values.resize(count);
        (*this)(std::span(values));
    }
    void finish() const {
        if (!left_.empty()) throw_other_size();
    }

private:
    [[noreturn]] void throw_other_size() const;
    std::string_view left_;
    const std::filesystem::path* file_;
};

/// A stage of work in `count` blocks, on all cores: work(block, worker), as parallel_for's, and done(block) after it. A
/// block that an earlier run finished is read from the journal, if there is one, instead; another one is kept there.
/// fields(visit, block) hands to visit() all that work() leaves of a block.
template <class Fields, class Work, class Done>
void finish_blocks(Journal* journal, size_t count, const Fields& fields, const Work& work, const Done& done) {
    const uint64_t stage = journal ? journal->begin_stage() : 0;
    const auto finish = [&](size_t block, int worker) {
        if (const auto kept = journal ? journal->find(stage, block) : std::nullopt) {
            BlockReader reader(*kept, journal->file());
            fields(reader, block);
            reader.finish();
        } else {
            work(block, worker);
            BlockWriter writer;
            if (journal) {
                fields(writer, block);
                journal->keep(stage, block, writer.bytes());
            }
        }
        done(block);
    };
    try {
        parallel_for(count, 1, finish);
    } catch (const Interrupted&) {
        if (journal) journal->flush();
        throw;
    }
}
template <class Fields, class Work>
void finish_blocks(Journal* journal, size_t count, const Fields& fields, const Work& work) {
    finish_blocks(journal, count, fields, work, [](size_t) {});
}

}  // namespace radiafit
