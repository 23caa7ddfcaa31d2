#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "capture_fixture.h"
#include "stereo/stereo_folder.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

using radiafit::testing::Bytes;

void put_model(const fs::path& folder, bool binary) {
    if (binary) {
        Bytes cameras, images;
        cameras.put(uint64_t{1}).put(uint32_t{1}).put(int32_t{1}).put(uint64_t{4}).put(uint64_t{3});
        for (const double p : {4.0, 4.0, 2.0, 1.5}) cameras.put(p);
        images.put(uint64_t{1}).put(uint32_t{3});
        for (const double p : {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0}) images.put(p);
        images.put(uint32_t{1});
        images.text += "a.png";
        images.put('\0').put(uint64_t{0});
        put_bytes(folder / "cameras.bin", cameras.text);
        put_bytes(folder / "images.bin", images.text);
    } else {
        put_bytes(folder / "cameras.txt", "1 PINHOLE 4 3 4 4 2 1.5\n");
        put_bytes(folder / "images.txt", "3 1 0 0 0 0 0 2 1 a.png\n\n");
    }
}

Target points(const char* name, const char* file, bool binary, const std::string& seed) {
    const auto seeds = [=](const fs::path& folder) {
        put_model(folder, binary);
        return std::vector<std::string>{seed};
    };
    return {name, file, seeds, [](const fs::path& folder) { read_colmap_points(folder, read_colmap(folder)); }};
}

std::string points_binary() {
    Bytes file;
    file.put(uint64_t{2});
    for (const uint64_t id : {1u, 2u}) {
        file.put(id).put(0.5).put(-1.0).put(2.0).put('\1').put('\2').put('\3').put(0.25).put(id);
        for (uint64_t k = 0; k < id; ++k) file.put(uint32_t{3}).put(uint32_t{7});
    }
    return file.text;
}

constexpr const char* depth_file = "depth_maps/a.png.geometric.bin";
constexpr const char* normal_file = "normal_maps/a.png.geometric.bin";

/// The map of depths or of normals; the other one is whole.
Target planes(const char* name, const char* file) {
    Camera camera;
    camera.width = 4, camera.height = 3, camera.fx = camera.fy = 4, camera.cx = 2, camera.cy = 1.5;
    const auto seeds = [=](const fs::path& folder) {
        PlaneMap map{camera, std::vector<InversePlane>(12, InversePlane::Zero())};
        for (size_t i = 0; i < 7; ++i) map.planes[i] = InversePlane(0.01f * float(i), 0.02f, 0.3f);
        write_planes(folder, "a.png", map);
        return std::vector<std::string>{bytes_of(folder / file)};
    };
    return {name, file, seeds, [=](const fs::path& folder) { read_planes(folder, "a.png", camera); }};
}

}  // namespace

std::vector<Target> stereo_targets() {
    return {points("colmap_points_text", "points3D.txt", false,
                   "# points\n1 0.5 -1 2 9 8 7 0.25 3 0 3 1\n2 0 0 0 0 0 0 1 3 2\n"),
            points("colmap_points_binary", "points3D.bin", true, points_binary()), planes("depth_map", depth_file),
            planes("normal_map", normal_file)};
}

}  // namespace radiafit::fuzz
