#include "base/npy_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <string>

namespace radiafit {
namespace {

/// Magic, version, the length of what follows, a Python dictionary, blanks up to a multiple of 64 bytes, a line's end.
std::string header_of(const char* type, const std::vector<uint64_t>& shape) {
    constexpr size_t before = 10, multiple = 64;
    // a tuple of one has a comma, too
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}{}), }}", type,
                                   fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
    const size_t length = (before + text.size() + multiple) / multiple * multiple - before;
    text.resize(length - 1, ' ');
    return fmt::format("\x93NUMPY\x01{}{}{}{}\n", '\0', char(length & 255), char(length >> 8), text);
}

uint64_t elements_of(const std::vector<uint64_t>& shape) {
    uint64_t product = 1;
    for (const uint64_t n : shape) product *= n;
    return product;
}

}  // namespace

template <class T>
NpyFile<T>::NpyFile(std::filesystem::path path, const std::vector<uint64_t>& shape) : out_(std::move(path)) {
    const std::string header = header_of(npy_type<T>(), shape);
    out_.write(header.data(), header.size());
    whole_ = header.size() + elements_of(shape) * sizeof(T);
}

template <class T>
void NpyFile<T>::close() {
    if (out_.bytes() != whole_) throw std::logic_error("NpyFile: not as many elements as its shape says");
    out_.close();
}

template class NpyFile<float>;
template class NpyFile<int32_t>;
template class NpyFile<int64_t>;

}  // namespace radiafit
