#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

namespace radiafit::tools {

/// A two-dimensional array as numpy.save writes it.
struct NpyMatrix {
    size_t rows = 0, columns = 0;
    std::vector<double> values;  ///< [rows][columns], not finite ones as they are

    double operator()(size_t row, size_t column) const { return values[row * columns + column]; }
};

/// Format 1, 2 or 3 of numpy.lib.format with little-endian floats of 4 or 8 bytes, in C or Fortran order. Throws
/// UserError that names file and cure: missing, truncated, longer than its shape, anything else.
NpyMatrix read_npy_matrix(const std::filesystem::path& file);

}  // namespace radiafit::tools
