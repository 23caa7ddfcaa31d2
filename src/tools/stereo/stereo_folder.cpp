#include "stereo/stereo_folder.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/read_file.h"
#include "stereo/output_names.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

fs::path depth_file(const fs::path& stereo, const std::string& name) {
    return stereo / "depth_maps" / (output_name(name).string() + ".geometric.bin");
}
fs::path normal_file(const fs::path& stereo, const std::string& name) {
    return stereo / "normal_maps" / (output_name(name).string() + ".geometric.bin");
}

void write_floats(const fs::path& file, const Camera& camera, int channels, const std::vector<float>& values) {
    std::string bytes = fmt::format("{}&{}&{}&", camera.width, camera.height, channels);
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    fs::create_directories(file.parent_path());
    write_file(file, bytes);
}

[[noreturn]] void fail(const fs::path& file, const std::string& why) {
    throw UserError(fmt::format("{}: {}: write the depth maps again", file.string(), why));
}

/// [channels][height][width]
std::vector<float> read_floats(const fs::path& file, const Camera& camera, int channels) {
    const std::string bytes = read_file(file, "depth or normal map");
    size_t at = 0;
    for (const int expected : {camera.width, camera.height, channels}) {
        int value = 0;
        const auto [end, code] = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), value);
        if (code != std::errc() || end == bytes.data() + bytes.size() || *end != '&')
            fail(file, "does not begin with WIDTH&HEIGHT&CHANNELS&");
        if (value != expected)
            fail(file, fmt::format("its size is not {} x {} with {} channels, as calibrated", camera.width,
                                   camera.height, channels));
        at = size_t(end - bytes.data()) + 1;
    }
    std::vector<float> values(size_t(camera.width) * size_t(camera.height) * size_t(channels));
    if (bytes.size() - at != values.size() * sizeof(float))
        fail(file, fmt::format("holds {} bytes of values, not {}", bytes.size() - at, values.size() * sizeof(float)));
    std::memcpy(values.data(), bytes.data() + at, values.size() * sizeof(float));
    return values;
}

}  // namespace

void write_planes(const fs::path& stereo, const std::string& name, const PlaneMap& map) {
    const Camera& camera = map.camera;
    const size_t count = map.planes.size();
    std::vector<float> depths(count, 0), normals(3 * count, 0);
    for (size_t i = 0; i < count; ++i) {
        const Vec3f ray = ray_of(camera, double(i % size_t(camera.width)), double(i / size_t(camera.width)));
        const float inverse_depth = map.planes[i].dot(ray);
        if (!(inverse_depth > 0)) continue;
        depths[i] = 1 / inverse_depth;
        const Vec3f normal = normal_of(map.planes[i]);
        for (size_t c = 0; c < 3; ++c) normals[c * count + i] = normal[int(c)];
    }
    write_floats(depth_file(stereo, name), camera, 1, depths);
    write_floats(normal_file(stereo, name), camera, 3, normals);
}

void write_fusion_list(const fs::path& stereo, const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names) list += name + "\n";
    write_file(stereo / "fusion.cfg", list);
}

PlaneMap read_planes(const fs::path& stereo, const std::string& name, const Camera& camera) {
    const fs::path depth_path = depth_file(stereo, name), normal_path = normal_file(stereo, name);
    const std::vector<float> depths = read_floats(depth_path, camera, 1), normals = read_floats(normal_path, camera, 3);
    const size_t count = depths.size();
    PlaneMap map{camera, std::vector<InversePlane>(count, InversePlane::Zero())};
    for (size_t i = 0; i < count; ++i) {
        if (depths[i] == 0) continue;
        const size_t x = i % size_t(camera.width), y = i / size_t(camera.width);
        if (!(depths[i] > 0 && std::isfinite(1 / depths[i])))
            fail(depth_path, fmt::format("pixel ({}, {}) has depth {}", x, y, depths[i]));
        const Vec3f ray = ray_of(camera, double(x), double(y)),
                    normal(normals[i], normals[count + i], normals[2 * count + i]);
        const float length = normal.norm();
        if (!(std::abs(length - 1) < 1e-2f && normal.dot(ray) < 0))
            fail(normal_path,
                 fmt::format("the normal of pixel ({}, {}) is no unit vector that faces the camera", x, y));
        map.planes[i] = make_plane(ray, 1 / depths[i], normal / length);
    }
    return map;
}

std::vector<PlaneMap> read_planes(const fs::path& stereo, const Calibration& model) {
    std::vector<PlaneMap> maps(model.images.size());
    parallel_for(maps.size(), 1,
                 [&](size_t i, int) { maps[i] = read_planes(stereo, model.images[i].name, model.images[i].camera); });
    return maps;
}

}  // namespace radiafit::tools
