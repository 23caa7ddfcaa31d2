#pragma once
#include <bit>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/file.h"

namespace radiafit {

/// What NumPy calls an element's type: "<f4" is a little-endian float of four bytes.
template <class T>
constexpr const char* npy_type() {
    static_assert(std::is_floating_point_v<T> || std::is_same_v<T, int32_t> || std::is_same_v<T, int64_t>);
    if (std::is_floating_point_v<T>) return sizeof(T) == 4 ? "<f4" : "<f8";
    return sizeof(T) == 4 ? "<i4" : "<i8";
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
extern template class NpyFile<double>;
extern template class NpyFile<int32_t>;
extern template class NpyFile<int64_t>;

/// An array as numpy.save wrote it, of any type of numbers that a double holds, or integers.
class NpyReader {
public:
    /// Reads the header. `what` is the file's role, such as "targets". Throws UserError that names the file: it is
    /// missing or no such array; its elements are no plain numbers or big-endian; it is shorter or longer than its
    /// shape says.
    NpyReader(const std::filesystem::path& file, const std::string& what);

    const std::string& file() const { return name_; }
    const std::vector<uint64_t>& shape() const { return shape_; }
    uint64_t elements() const;
    bool whole_numbers() const { return kind_ != 'f'; }
    std::string type() const { return {'<', kind_, char('0' + bytes_)}; }  ///< as npy_type() names it
    std::string shape_text() const;                                        ///< "(3, 4)"
    /// All elements in C order, whichever the file's is. T: float or double, to which numbers are rounded (UserError
    /// for those beyond what a float holds); or int64_t, of whole numbers alone (UserError).
    template <class T>
    std::vector<T> read() const;
    /// Of these so many from an element on. Throws std::logic_error beyond the end, and for the parts of an array whose
    /// first index runs fastest.
    template <class T>
    std::vector<T> read(uint64_t first, uint64_t count) const;
    bool first_index_fastest() const { return fortran_; }

private:
    [[noreturn]] void fail(const std::string& problem) const;

    std::string name_;
    InputFile in_;
    char kind_ = 'f';  ///< 'f', 'i', 'u' or 'b'
    bool fortran_ = false;
    uint64_t bytes_ = 4, begin_ = 0;
    std::vector<uint64_t> shape_;
};

extern template std::vector<float> NpyReader::read() const;
extern template std::vector<double> NpyReader::read() const;
extern template std::vector<int64_t> NpyReader::read() const;
extern template std::vector<float> NpyReader::read(uint64_t, uint64_t) const;
extern template std::vector<double> NpyReader::read(uint64_t, uint64_t) const;

}  // namespace radiafit
