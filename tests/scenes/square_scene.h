#pragma once
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "dataset/dataset.h"

/// A flat square, seen from directions that are known.
namespace radiafit::testing {

inline constexpr double degree = std::numbers::pi / 180;
inline constexpr int square_size = 32;  // of its pictures

/// Around y, from z.
inline Vec3d tilted(double degrees) { return {std::sin(degrees * degree), 0, std::cos(degrees * degree)}; }

struct Shot {
    Vec3d eye;
    bool held_out;
    std::function<bool(int x)> masked_in = [](int) { return true; };
    std::optional<Vec3d> lamp = {};
    std::optional<Vec3d> camera_direction = {};
};

/// A square of two halves in the plane z = 0, each of two triangles, which fills the pictures nearly; bytes of 128.
/// Halves: x below 0 are triangles 0 and 1.
inline Dataset write_square(const std::filesystem::path& folder, const std::vector<Shot>& shots, bool grid = false) {
    Dataset header;
    header.name = "square";
    if (grid)
        header.grid = Grid::centered(square_size, square_size, 0.1);
    else {
        header.mesh.positions = {{-1, -1, 0}, {0, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
        header.mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    }
    DatasetWriter writer(folder);
    int count = 0;
    for (const Shot& shot : shots) {
        View view;
        view.name = "view" + std::to_string(count++);
        view.camera.width = view.camera.height = square_size;
        if (!shot.camera_direction)
            view.camera = Camera::look_at(shot.eye, Vec3d::Zero(), Vec3d::UnitY(), 2.1 / shot.eye.norm(), square_size,
                                          square_size);
        view.camera_direction = shot.camera_direction;
        if (shot.lamp) view.light = Light{Light::Kind::distant, *shot.lamp, Vec3d::Ones()};
        view.held_out = shot.held_out;
        std::vector<uint8_t> mask;
        for (int i = 0; i < square_size * square_size; ++i) mask.push_back(shot.masked_in(i % square_size));
        writer.add(view, std::vector<uint8_t>(3 * square_size * square_size, 128).data(), mask);
    }
    writer.finish(header);
    return open_dataset(folder);
}

}  // namespace radiafit::testing
