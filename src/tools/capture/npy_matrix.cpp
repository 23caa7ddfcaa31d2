#include "capture/npy_matrix.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/read_file.h"

namespace radiafit::tools {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem) {
    throw UserError(fmt::format("{}: {}: write it by numpy.save as a matrix of float64", file.string(), problem));
}

/// What follows a key of the header's Python dictionary.
std::string_view behind(std::string_view header, std::string_view key, const std::filesystem::path& file) {
    const size_t at = header.find(key);
    if (at == std::string_view::npos) fail(file, fmt::format("the header has no {}", key));
    const std::string_view rest = header.substr(at + key.size());
    const size_t first = rest.find_first_not_of(": ");
    return first == std::string_view::npos ? std::string_view() : rest.substr(first);
}

/// Takes "(rows, columns)" apart.
void read_shape(std::string_view text, NpyMatrix& matrix, const std::filesystem::path& file) {
    const char* end = text.data() + text.size();
    const auto number = [&](const char* from, size_t& value) {
        while (from != end && (*from == ' ' || *from == '(' || *from == ',')) ++from;
        const auto parsed = std::from_chars(from, end, value);
        if (parsed.ec != std::errc()) fail(file, "the shape is not one of a matrix");
        return parsed.ptr;
    };
    const char* last = number(number(text.data(), matrix.rows), matrix.columns);
    if (last == end || *last != ')') fail(file, "the shape is not one of a matrix");
}

template <class T>
T little_endian(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

}  // namespace

NpyMatrix read_npy_matrix(const std::filesystem::path& file) {
    const std::string bytes = read_file(file, "array file");
    const std::string_view magic = "\x93NUMPY";
    if (bytes.size() < 12 || !std::string_view(bytes).starts_with(magic)) fail(file, "is no .npy file, or truncated");
    const bool first_format = bytes[6] == 1;  // two bytes say the header's length, later four
    const size_t start = first_format ? 10 : 12;
    const size_t length =
        first_format ? size_t(little_endian<uint16_t>(&bytes[8])) : size_t(little_endian<uint32_t>(&bytes[8]));
    if (length > bytes.size() - start) fail(file, "truncated within its header");
    const std::string_view header = std::string_view(bytes).substr(start, length);

    const std::string_view type = behind(header, "'descr'", file), order = behind(header, "'fortran_order'", file);
    const size_t element = type.starts_with("'<f8'") ? 8 : type.starts_with("'<f4'") ? 4 : 0;
    if (element == 0) fail(file, "holds no little-endian floats");
    const bool fortran = order.starts_with("True");
    NpyMatrix matrix;
    read_shape(behind(header, "'shape'", file), matrix, file);
    const size_t count = (bytes.size() - start - length) / element;
    const bool fits = matrix.columns > 0 && matrix.rows == count / matrix.columns && count % matrix.columns == 0;
    if (!fits || start + length + count * element != bytes.size())
        fail(file, fmt::format("{} bytes follow the header, not the {} x {} numbers of {} bytes that it promises: "
                               "truncated or damaged",
                               bytes.size() - start - length, matrix.rows, matrix.columns, element));
    matrix.values.resize(count);
    for (size_t i = 0; i < count; ++i) {
        const char* at = bytes.data() + start + length + i * element;
        const double value = element == 8 ? little_endian<double>(at) : double(little_endian<float>(at));
        matrix.values[fortran ? i % matrix.rows * matrix.columns + i / matrix.rows : i] = value;
    }
    return matrix;
}

}  // namespace radiafit::tools
