#include "model/penalty.h"

#include <algorithm>

#include "model/lfm_start.h"

namespace radiafit {

template <class Inside>
MapNeighbours MapNeighbours::make(int side, const Inside& local_of) {
    MapNeighbours map;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const int texel = local_of(i, j);
            if (texel < 0) continue;
            auto& around = map.neighbours_.emplace_back();
            around.fill(uint16_t(texel));
            uint8_t& count = map.count_.emplace_back();
            for (const auto& [x, y] : {std::array{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
                const int neighbour = x < 0 || y < 0 || x >= side || y >= side ? -1 : local_of(x, y);
                if (neighbour >= 0) around[count++] = uint16_t(neighbour);
            }
        }
    return map;
}

const MapNeighbours& MapNeighbours::triangle(int side) {
    const TriangleTile& wanted = TriangleTile::of_side(side);
    static const std::vector<MapNeighbours> all = [] {
        std::vector<MapNeighbours> maps;
        for (int n = least_side; n <= largest_side; ++n) {
            const TriangleTile& tile = TriangleTile::of_side(n);
            maps.push_back(make(n, [&](int i, int j) { return i + j < n ? int(tile.local_of_cell(i, j)) : -1; }));
        }
        return maps;
    }();
    return all[size_t(wanted.side() - least_side)];
}

MapNeighbours MapNeighbours::square(int side) {
    return make(side, [side](int i, int j) { return j * side + i; });
}

std::array<double, 3> penalty_error(const LfmLayout& layout, const LfmOptions& options, const MapNeighbours& view,
                                    size_t v, std::span<const float> p, std::span<const float> mean) {
    using V = Lanes<double>;
    const size_t size = layout.block_size(v) / 4, ring_texels = layout.surface_texels(v);
    const size_t view_begin = ring_texels * size_t(layout.terms());
    std::vector<V> x(size), unused(size), scratch(2 * size);
    for (size_t i = 0; i < size; ++i)
        for (int c = 0; c < 3; ++c) x[i][c] = p[layout.offset(v) + 4 * i + c];
    V lambda_view{};
    for (int c = 0; c < 3; ++c) lambda_view[c] = scaled_lambda_view(options, ring_texels, mean[c]);
    V error{};
    size_t at = 0;
    for (const int side : layout.sides(v)) {
        const MapNeighbours& tile = MapNeighbours::triangle(side);
        add_smoothness<double>(tile, options.terms, broadcast3(double(options.lambda_surface)), &x[at], &unused[at],
                               error, scratch.data());
        at += tile.texel_count() * size_t(options.terms);
    }
    add_smoothness<double>(view, options.terms, lambda_view, &x[view_begin], &unused[view_begin], error,
                           scratch.data());
    add_bounds<double>(options, size / options.terms, x.data(), unused.data(), error);
    return {error[0], error[1], error[2]};
}

}  // namespace radiafit
