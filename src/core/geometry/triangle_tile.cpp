#include "geometry/triangle_tile.h"

#include <fmt/format.h>

#include "base/error.h"

namespace radiafit {

TriangleTile::TriangleTile(int side) : side_(side) {
    for (int j = 0; j < side; ++j)
        for (int i = 0; i + j < side; ++i) {
            // The diagonal cuts the cells i + j = side - 1 in half: their centre is a triangle's centroid.
            const double c = i + j == side - 1 ? 1.0 / 3 : 0.5;
            const double b1 = (i + c) / side, b2 = (j + c) / side;
            cell_.push_back({i, j});
            barycentric_.push_back({float(1 - b1 - b2), float(b1), float(b2)});
        }
}

const TriangleTile& TriangleTile::of_side(int side) {
    if (side < least_side || side > largest_side)
        throw UserError(
            fmt::format("surface side {} is out of range; choose one in [{}, {}]", side, least_side, largest_side));
    static const std::vector<TriangleTile> tiles = [] {
        std::vector<TriangleTile> all;
        for (int n = least_side; n <= largest_side; ++n) all.push_back(TriangleTile(n));
        return all;
    }();
    return tiles[size_t(side - least_side)];
}

}  // namespace radiafit
