#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"

namespace radiafit {

/// A file of `count` values in the machine's byte order, and nothing else. damaged(file, what) throws; it is called
/// where the file is missing or of another length than `whose`, such as "36 texels", need.
template <class T>
std::vector<T> read_values(const std::filesystem::path& file, size_t count, const std::string& whose,
                           void (*damaged)(const std::filesystem::path& file, const std::string& what)) {
    std::error_code error;
    const uint64_t bytes = std::filesystem::file_size(file, error);
    if (error) damaged(file, "the file is missing or cannot be read");
    if (bytes % sizeof(T) != 0 || bytes / sizeof(T) != count)  // a product might overflow
        damaged(file, fmt::format("the file has {} bytes, but {} need {} each", bytes, whose, sizeof(T)));
    std::vector<T> values(count);
    InputFile(file).read(values.data(), 0, bytes);
    return values;
}

}  // namespace radiafit
