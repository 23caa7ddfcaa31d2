#include <fmt/format.h>

#include <string_view>

#include "fit/fit_folder.h"

namespace radiafit {
namespace {

// FNV-1a, 64 bits: enough to notice a different data set, not meant against forgery.
class Digest {
public:
    void bytes(const void* data, size_t size) {
        const auto* p = static_cast<const unsigned char*>(data);
        for (size_t i = 0; i < size; ++i) hash_ = (hash_ ^ p[i]) * 0x100000001b3u;
    }
    template <class T>
    void add(const T& value) {
        static_assert(std::is_arithmetic_v<T>);
        bytes(&value, sizeof value);
    }
    std::string text() const { return fmt::format("{:016x}", hash_); }

private:
    uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace

DatasetFingerprint fingerprint(const Dataset& dataset) {
    DatasetFingerprint f;
    f.vertices = dataset.mesh.vertex_count();
    f.triangles = dataset.mesh.triangle_count();
    f.views = dataset.views.size();
    f.held_out = dataset.split(true).size();
    f.image_bytes = dataset.image_bytes();
    Digest digest;
    for (const Vec3f& p : dataset.mesh.positions) digest.bytes(p.data(), 3 * sizeof(float));
    for (const auto& t : dataset.mesh.triangles) digest.bytes(t.data(), sizeof t);
    const std::string encoding = to_string(dataset.encoding);
    digest.bytes(encoding.data(), encoding.size());
    for (const View& view : dataset.views) {
        digest.bytes(view.name.data(), view.name.size());
        const Camera& c = view.camera;
        digest.add(c.width);
        digest.add(c.height);
        for (const double x : {c.fx, c.fy, c.cx, c.cy, view.gain}) digest.add(x);
        for (int i = 0; i < 9; ++i) digest.add(c.cam_from_world_rotation(i / 3, i % 3));
        for (int i = 0; i < 3; ++i) digest.add(c.cam_from_world_translation[i]);
        if (view.camera_direction)
            for (int i = 0; i < 3; ++i) digest.add((*view.camera_direction)[i]);
        digest.add(view.held_out);
        if (!view.light) continue;
        digest.add(int(view.light->kind));
        for (int i = 0; i < 3; ++i) digest.add(view.light->place[i]), digest.add(view.light->intensity[i]);
    }
    for (const Vec3f& n : dataset.normal_map.normals) digest.bytes(n.data(), 3 * sizeof(float));
    if (dataset.has_grid()) {
        const Grid& grid = dataset.grid;
        for (const Vec3d& v : {grid.origin, grid.right, grid.down}) digest.bytes(v.data(), 3 * sizeof(double));
        for (const Vec3f& n : grid.texel_normals) digest.bytes(n.data(), 3 * sizeof(float));
    }
    f.digest = digest.text();
    return f;
}

}  // namespace radiafit
