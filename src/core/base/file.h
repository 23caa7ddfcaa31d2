#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

/// Files that are too large for streams: reads at offsets from several threads, long sequential writes, and what the
/// page cache holds of them.
namespace radiafit {

/// Throws SystemError, quoting the call, when the file cannot be opened or read whole; UserError where that is
/// forbidden.
class InputFile {
public:
    explicit InputFile(std::filesystem::path path);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    /// Thread-safe.
    void read(void* to, uint64_t offset, uint64_t bytes) const;
    uint64_t size() const;
    /// Asks the kernel not to read ahead of what is asked for.
    void no_readahead() const;
    /// Asks the kernel to drop these bytes from its page cache.
    void forget(uint64_t offset, uint64_t bytes) const;
    int descriptor() const { return file_; }

private:
    std::filesystem::path path_;
    int file_;
};

/// Throws UserError "cannot write PATH: REASON; CURE", with the name that the user knows, not a hidden one.
/// `error`: errno.
[[noreturn]] void throw_unwritable(const std::filesystem::path& path, int error);

/// Writes from front to back through a buffer. Throws as throw_unwritable() does; close() must be called for the file
/// to be whole.
class OutputFile {
public:
    explicit OutputFile(std::filesystem::path path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* from, size_t bytes);
    void close();
    uint64_t bytes() const { return bytes_; }  ///< written so far
    /// Shows other processes that this one writes it (leftovers.h), where the file system has locks.
    void lock() const;

private:
    void flush(const uint8_t* from, size_t bytes);

    std::filesystem::path path_;
    int file_;
    std::vector<uint8_t> buffer_;
    uint64_t bytes_ = 0;
};

/// Waits until a file's data, or a folder's names, are on the disk. Throws as throw_unwritable() does; a file system
/// that has no such thing is no error.
void sync_to_disk(const std::filesystem::path& path);

/// Share of a file's pages that are in memory, by mincore.
double cached_share(const std::filesystem::path& path);
/// Waits until the file is on the disk and asks the kernel to forget its pages. Look at cached_share() whether it did.
void drop_from_cache(const std::filesystem::path& path);

}  // namespace radiafit
