#pragma once
#include <bit>
#include <cstdint>
#include <filesystem>
#include <span>
#include <type_traits>
#include <vector>

#include "base/file.h"

namespace radiafit {

/// What NumPy calls an element's type: "<f4" is a little-endian float of four bytes.
template <class T>
constexpr const char* npy_type() {
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, int32_t> || std::is_same_v<T, int64_t>);
    return std::is_same_v<T, float> ? "<f4" : sizeof(T) == 4 ? "<i4" : "<i8";
}

/// An array of any dimensions as numpy.load reads it: its elements in C order (the last index runs fastest) behind a
/// header of text, format 1.0 of numpy.lib.format. Elements are written from front to back; errors as OutputFile's.
template <class T>
class NpyFile {
    static_assert(std::endian::native == std::endian::little);

public:
    NpyFile(std::filesystem::path path, const std::vector<uint64_t>& shape);
    void write(std::span<const T> elements) { out_.write(elements.data(), elements.size_bytes()); }
    void write(T element) { out_.write(&element, sizeof element); }
    /// Throws std::logic_error unless there are as many elements as the shape says.
    void close();

private:
    OutputFile out_;
    uint64_t whole_;  ///< bytes of header and elements
};

extern template class NpyFile<float>;
extern template class NpyFile<int32_t>;
extern template class NpyFile<int64_t>;

}  // namespace radiafit
