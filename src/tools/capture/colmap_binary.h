#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include "base/error.h"
#include "base/read_file.h"

namespace radiafit::tools {

/// The bytes of a binary model file of COLMAP, little-endian, from front to back. What lies beyond the end is a
/// UserError.
class ColmapBinary {
public:
    explicit ColmapBinary(const std::filesystem::path& file) : file_(file), bytes_(read_file(file, "COLMAP file")) {}
    template <class T>
    T get() {
        T value;
        std::memcpy(&value, take(sizeof(T)), sizeof(T));
        return value;
    }
    std::string get_string() {
        const auto end = std::find(bytes_.begin() + static_cast<ptrdiff_t>(at_), bytes_.end(), '\0');
        const size_t length = static_cast<size_t>(end - bytes_.begin()) - at_;
        const char* first = take(length + 1);
        return {first, length};
    }
    void skip(uint64_t count, uint64_t size) {
        if (count > (bytes_.size() - at_) / size) fail_truncated();
        at_ += count * size;
    }
    void set_entry(std::string entry) { entry_ = std::move(entry); }
    void expect_end() const {
        if (at_ != bytes_.size())
            throw UserError(
                fmt::format("{}: {} bytes follow the last entry, so this is no COLMAP file or a damaged "
                            "one: write the model again",
                            file_.string(), bytes_.size() - at_));
    }
    const std::filesystem::path& file() const { return file_; }

private:
    const char* take(size_t size) {
        if (size > bytes_.size() - at_) fail_truncated();
        at_ += size;
        return bytes_.data() + at_ - size;
    }
    [[noreturn]] void fail_truncated() const {
        throw UserError(fmt::format("{}: truncated: {} bytes end within {}: copy or write the model again",
                                    file_.string(), bytes_.size(), entry_));
    }
    std::filesystem::path file_;
    std::string bytes_;
    size_t at_ = 0;
    std::string entry_ = "the header";
};

}  // namespace radiafit::tools
