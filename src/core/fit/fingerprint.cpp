#include <fmt/format.h>

#include <type_traits>

#include "base/hash.h"
#include "fit/fit_folder.h"

namespace radiafit {

DatasetFingerprint fingerprint(const Dataset& dataset) {
    DatasetFingerprint f;
    f.vertices = dataset.mesh.vertex_count();
    f.triangles = dataset.mesh.triangle_count();
    f.views = dataset.views.size();
    f.held_out = dataset.split(true).size();
    f.image_bytes = dataset.image_bytes();
    uint64_t digest = hash_start;
    const auto add_bytes = [&](const void* data, size_t size) { digest = hash_byte_by_byte(data, size, digest); };
    const auto add = [&](const auto& value) {
        static_assert(std::is_arithmetic_v<std::decay_t<decltype(value)>>);
        add_bytes(&value, sizeof value);
    };
    for (const Vec3f& p : dataset.mesh.positions) add_bytes(p.data(), 3 * sizeof(float));
    for (const auto& t : dataset.mesh.triangles) add_bytes(t.data(), sizeof t);
    const std::string encoding = to_string(dataset.encoding);
    add_bytes(encoding.data(), encoding.size());
    for (const View& view : dataset.views) {
        add_bytes(view.name.data(), view.name.size());
        const Camera& c = view.camera;
        add(c.width);
        add(c.height);
        for (const double x : {c.fx, c.fy, c.cx, c.cy, view.gain[0]}) add(x);
        if (!view.gain.uniform()) add(view.gain[1]), add(view.gain[2]);
        for (int i = 0; i < 9; ++i) add(c.cam_from_world_rotation(i / 3, i % 3));
        for (int i = 0; i < 3; ++i) add(c.cam_from_world_translation[i]);
        if (view.camera_direction)
            for (int i = 0; i < 3; ++i) add((*view.camera_direction)[i]);
        add(view.held_out);
        if (!view.light) continue;
        add(int(view.light->kind));
        for (int i = 0; i < 3; ++i) add(view.light->place[i]), add(view.light->intensity[i]);
    }
    for (const Vec3f& n : dataset.normal_map.normals) add_bytes(n.data(), 3 * sizeof(float));
    if (dataset.has_grid()) {
        const Grid& grid = dataset.grid;
        for (const Vec3d& v : {grid.origin, grid.right, grid.down}) add_bytes(v.data(), 3 * sizeof(double));
        for (const Vec3f& n : grid.texel_normals) add_bytes(n.data(), 3 * sizeof(float));
    }
    f.digest = fmt::format("{:016x}", digest);
    return f;
}

}  // namespace radiafit
