#include "model/penalty.h"

#include <algorithm>

#include "model/lfm_start.h"

namespace radiafit {

template <class Inside>
MapNeighbours MapNeighbours::make(int side, const Inside& local_of) {
    MapNeighbours map;
    map.first_.push_back(0);
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            if (local_of(i, j) < 0) continue;
            for (const auto& [x, y] : {std::array{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
                const int neighbour = x < 0 || y < 0 || x >= side || y >= side ? -1 : local_of(x, y);
                if (neighbour >= 0) map.neighbour_.push_back(static_cast<uint16_t>(neighbour));
            }
            map.first_.push_back(static_cast<uint32_t>(map.neighbour_.size()));
        }
    return map;
}

MapNeighbours MapNeighbours::triangle(int side) {
    return make(side, [side](int i, int j) { return i + j < side ? j * side - j * (j - 1) / 2 + i : -1; });
}

MapNeighbours MapNeighbours::square(int side) {
    return make(side, [side](int i, int j) { return j * side + i; });
}

std::array<double, 3> penalty_error(const LfmLayout& layout, const LfmOptions& options, size_t v,
                                    std::span<const float> p, std::span<const float> mean) {
    using V = Lanes<double>;
    const MapNeighbours tile = MapNeighbours::triangle(options.surface_side);
    const MapNeighbours view = MapNeighbours::square(options.view_side);
    const size_t size = layout.block_size(v) / 4, tile_lanes = layout.tile_size() / 4;
    const size_t view_begin = (layout.view_offset(v) - layout.offset(v)) / 4;
    std::vector<V> x(size), unused(size), scratch(2 * size_t(std::max(layout.tile_texels(), layout.view_texels())));
    for (size_t i = 0; i < size; ++i)
        for (int c = 0; c < 3; ++c) x[i][c] = p[layout.offset(v) + 4 * i + c];
    V lambda_view{};
    const size_t ring_texels = view_begin / size_t(layout.terms());
    for (int c = 0; c < 3; ++c) lambda_view[c] = scaled_lambda_view(options, ring_texels, mean[c]);
    V error{};
    for (size_t at = 0; at < view_begin; at += tile_lanes)
        add_smoothness<double>(tile, options.terms, broadcast3(double(options.lambda_surface)), &x[at], &unused[at],
                               error, scratch.data());
    add_smoothness<double>(view, options.terms, lambda_view, &x[view_begin], &unused[view_begin], error,
                           scratch.data());
    add_bounds<double>(options, size / options.terms, x.data(), unused.data(), error);
    return {error[0], error[1], error[2]};
}

}  // namespace radiafit
