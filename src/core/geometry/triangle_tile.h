#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace radiafit {

inline constexpr int least_side = 2, largest_side = 64;  ///< of a triangle's tile

/// Triangular tile of side n: cells floor(b1 n), floor(b2 n) of barycentric coordinates, i + j < n, so n(n+1)/2 texels.
class TriangleTile {
public:
    /// Throws UserError for a side outside [least_side, largest_side]. The tile lives as long as the program.
    static const TriangleTile& of_side(int side);
    static constexpr uint32_t texels_of(int side) { return static_cast<uint32_t>(side * (side + 1) / 2); }

    int side() const { return side_; }
    uint32_t texels() const { return texels_of(side_); }
    /// The texel that holds barycentric (b1, b2); rounding at the rim is clamped into the tile.
    static uint32_t local_at(int side, float b1, float b2) {
        int i = std::clamp(static_cast<int>(b1 * float(side)), 0, side - 1);
        int j = std::clamp(static_cast<int>(b2 * float(side)), 0, side - 1);
        // Beyond the diagonal by rounding only: step back along the longer coordinate.
        const int beyond = std::max(0, i + j - (side - 1));
        const bool along_i = i > j;
        i -= along_i ? beyond : 0;
        j -= along_i ? 0 : beyond;
        return local_of_cell(side, i, j);
    }
    uint32_t local_at(float b1, float b2) const { return local_at(side_, b1, b2); }
    /// Barycentric weights of the three vertices at a texel's centre. A diagonal cell's own centroid.
    const std::array<float, 3>& barycentric(uint32_t local) const { return barycentric_[local]; }
    /// Cell (i, j) of a texel. Local order: row by row, j outer, i inner.
    std::array<int, 2> cell(uint32_t local) const { return cell_[local]; }
    uint32_t local_of_cell(int i, int j) const { return local_of_cell(side_, i, j); }

private:
    explicit TriangleTile(int side);
    static uint32_t local_of_cell(int side, int i, int j) {
        return static_cast<uint32_t>(j * side - j * (j - 1) / 2 + i);
    }

    int side_;
    std::vector<std::array<float, 3>> barycentric_;
    std::vector<std::array<int, 2>> cell_;
};

}  // namespace radiafit
