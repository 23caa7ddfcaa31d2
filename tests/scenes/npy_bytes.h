#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace radiafit::testing {

/// Little-endian bytes of numbers.
template <class T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

/// In format 1.0, as numpy.save writes it. shape: "(2, 3)"; data: the elements.
inline std::string npy(const std::string& type, bool fortran, const std::string& shape, const std::string& data) {
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': {}, }}", type, fortran ? "True" : "False", shape);
    header.resize((10 + header.size() + 64) / 64 * 64 - 10, ' ');
    header.back() = '\n';
    return "\x93NUMPY\x01" + std::string(1, '\0') + bytes_of<uint16_t>({uint16_t(header.size())}) + header + data;
}

}  // namespace radiafit::testing
