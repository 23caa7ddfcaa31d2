#include "base/npy_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/half.h"
#include "base/read_file.h"

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

/// What stands behind 'KEY': in a header, up to the comma that ends it, or to the parenthesis; empty: no such key.
std::string_view entry_of(std::string_view header, const std::string& key) {
    const size_t found = header.find("'" + key + "':");
    if (found == std::string_view::npos) return {};
    std::string_view rest = header.substr(found + key.size() + 3);
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    const size_t end = rest.starts_with('(') ? rest.find(')') : rest.find_first_of(",}");
    return rest.substr(0, end == std::string_view::npos ? 0 : end + (rest.starts_with('(') ? 1 : 0));
}

template <class T>
T number_at(const char* from) {
    T x;
    std::memcpy(&x, from, sizeof x);
    return x;
}

/// One element, as a double or a whole number.
template <class To>
To element_at(const char* from, char kind, uint64_t bytes) {
    switch (kind) {
        case 'f':
            if (bytes == 2) return To(float_from_half(number_at<uint16_t>(from)));
            return bytes == 4 ? To(number_at<float>(from)) : To(number_at<double>(from));
        case 'i':
            if (bytes == 1) return To(number_at<int8_t>(from));
            if (bytes == 2) return To(number_at<int16_t>(from));
            return bytes == 4 ? To(number_at<int32_t>(from)) : To(number_at<int64_t>(from));
        default:
            if (bytes == 1) return To(number_at<uint8_t>(from));
            if (bytes == 2) return To(number_at<uint16_t>(from));
            return bytes == 4 ? To(number_at<uint32_t>(from)) : To(number_at<uint64_t>(from));
    }
}

/// Arrays whose first index runs fastest.
class FortranOrder {
public:
    explicit FortranOrder(std::vector<uint64_t> shape) : shape_(std::move(shape)) {}

    /// Of the element that comes at a place in the file: its place where the last index runs fastest.
    uint64_t place_in_c_order(uint64_t place) const {
        uint64_t out = 0, stride = elements_of(shape_);
        for (const uint64_t n : shape_) {
            stride /= n;
            out += place % n * stride;
            place /= n;
        }
        return out;
    }

private:
    std::vector<uint64_t> shape_;
};

const std::filesystem::path& there(const std::filesystem::path& file, const std::string& what) {
    if (!path_exists(file)) throw UserError(fmt::format("{}: missing {}", file.string(), what));
    if (!std::filesystem::is_regular_file(file)) throw UserError(fmt::format("{}: no file", file.string()));
    return file;
}

}  // namespace

NpyReader::NpyReader(const std::filesystem::path& file, const std::string& what)
    : name_(file.string()), in_(there(file, what)) {
    const uint64_t size = in_.size();
    char start[12] = {};
    in_.read(start, 0, std::min<uint64_t>(size, sizeof start));
    if (std::string_view(start, 6) != "\x93NUMPY") fail("no array of numpy.save, or cut");
    const bool long_header = start[6] > 1;
    uint64_t length = uint64_t(uint8_t(start[8])) | uint64_t(uint8_t(start[9])) << 8;
    if (long_header) length |= uint64_t(uint8_t(start[10])) << 16 | uint64_t(uint8_t(start[11])) << 24;
    const uint64_t before = long_header ? 12 : 10;
    constexpr uint64_t longest = 1 << 16;
    if (length > longest || before + length > size) fail("its header is damaged; save it again by numpy.save");
    std::string header(length, ' ');
    in_.read(header.data(), before, length);
    begin_ = before + length;

    const std::string_view type = entry_of(header, "descr"), order = entry_of(header, "fortran_order");
    std::string_view shape = entry_of(header, "shape");
    if (type.size() < 5) fail("its elements are no plain numbers; numpy.save an array of numbers");
    const std::string descr(type.substr(1, type.size() - 2));
    bytes_ = uint64_t(descr.back() - '0');
    kind_ = descr[1];
    const bool known = descr.size() == 3 &&
                       (kind_ == 'f'   ? bytes_ == 2 || bytes_ == 4 || bytes_ == 8
                        : kind_ == 'b' ? bytes_ == 1
                                       : (kind_ == 'i' || kind_ == 'u') && std::has_single_bit(bytes_) && bytes_ <= 8);
    if (!known)
        fail(fmt::format("elements of type '{}' are no plain numbers; numpy.save it as float32 or float64", descr));
    if (descr[0] == '>') fail("big-endian; numpy.save it as little-endian, such as a.astype('<f8')");
    fortran_ = order == "True";
    if (!shape.starts_with('(')) fail("its shape is damaged; save it again by numpy.save");
    shape = shape.substr(1, shape.size() - 2);
    while (!shape.empty()) {
        uint64_t n = 0;
        const auto [end, code] = std::from_chars(shape.data(), shape.data() + shape.size(), n);
        if (code != std::errc{}) fail("its shape is damaged; save it again by numpy.save");
        shape_.push_back(n);
        shape.remove_prefix(size_t(end - shape.data()));
        shape.remove_prefix(std::min(shape.find_first_not_of(", "), shape.size()));
    }
    uint64_t wanted = bytes_;
    for (const uint64_t n : shape_)
        if (__builtin_mul_overflow(wanted, n, &wanted)) fail("its shape is damaged; save it again by numpy.save");
    if (size - begin_ != wanted)
        fail(
            fmt::format("{}: {} bytes follow its header, not the {} of its shape {}; copy it again, or numpy.save one "
                        "array",
                        size - begin_ < wanted ? "cut" : "too long", size - begin_, wanted, shape_text()));
}

void NpyReader::fail(const std::string& problem) const { throw UserError(name_ + ": " + problem); }

uint64_t NpyReader::elements() const { return elements_of(shape_); }

std::string NpyReader::shape_text() const {
    return fmt::format("({}{})", fmt::join(shape_, ", "), shape_.size() == 1 ? "," : "");
}

template <class T>
std::vector<T> NpyReader::read() const {
    return read<T>(0, elements());
}

template <class T>
std::vector<T> NpyReader::read(uint64_t begin, uint64_t size) const {
    if (begin + size > elements() || (fortran_ && size != elements()))
        throw std::logic_error("NpyReader: no such elements");
    if (std::is_integral_v<T> && !whole_numbers())
        fail("has fractions; save whole numbers, such as by a.astype('int64')");
    std::vector<T> out(size);
    const FortranOrder order(fortran_ ? shape_ : std::vector<uint64_t>());
    constexpr uint64_t at_once = 1 << 20;
    std::vector<char> bytes(std::min<uint64_t>(at_once, out.size()) * bytes_);
    for (uint64_t first = 0; first < out.size(); first += at_once) {
        const uint64_t count = std::min<uint64_t>(at_once, out.size() - first);
        in_.read(bytes.data(), begin_ + (begin + first) * bytes_, count * bytes_);
        for (uint64_t i = 0; i < count; ++i) {
            T& to = out[fortran_ ? order.place_in_c_order(first + i) : first + i];
            to = element_at<T>(&bytes[i * bytes_], kind_, bytes_);
            if constexpr (std::is_same_v<T, float>)
                if (const auto x = element_at<double>(&bytes[i * bytes_], kind_, bytes_);
                    std::isfinite(x) && (!std::isfinite(to) || (to == 0) != (x == 0)))
                    fail(fmt::format("{} is beyond what floats hold; fit in doubles", x));
        }
    }
    return out;
}

template std::vector<float> NpyReader::read() const;
template std::vector<double> NpyReader::read() const;
template std::vector<int64_t> NpyReader::read() const;
template std::vector<float> NpyReader::read(uint64_t, uint64_t) const;
template std::vector<double> NpyReader::read(uint64_t, uint64_t) const;

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
template class NpyFile<double>;
template class NpyFile<int32_t>;
template class NpyFile<int64_t>;

}  // namespace radiafit
