#include "model/penalty.h"

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

}  // namespace radiafit
