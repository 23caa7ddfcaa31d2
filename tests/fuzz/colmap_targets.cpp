#include "capture/colmap.h"
#include "capture_fixture.h"
#include "lens_trial.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

using radiafit::testing::Bytes;

std::string cameras_text() {
    return "# cameras\n1 PINHOLE 64 48 60 61 32 24\n7 SIMPLE_PINHOLE 10 20 9.5 5 10\n8 OPENCV 9 8 7 6 5 4 0 0 -0 0\n"
           "9 FULL_OPENCV 9 8 7 6 5 4 -0.1 0.01 1e-3 0 0.2 1e-2 0 0.3\n10 OPENCV_FISHEYE 9 8 7 6 5 4 0 0.1 0 -0.2\n"
           "11 THIN_PRISM_FISHEYE 9 8 7 6 5 4 0.1 0 0 0 0 0 0.01 0\n12 FOV 9 8 7 6 5 4 0.9\n";
}
std::string images_text() {
    return "# images\n1 1 0 0 0 0.5 -1e-3 2 1 a.png\n1 2 -1 3.5 4 7\n2 0.5 0.5 -0.5 0.5 0 0 0 7 sub/b c.png\n\n"
           "3 1 0 0 0 0 0 0 9 c.png\n\n4 1 0 0 0 0 0 0 10 d.png\n\n5 1 0 0 0 0 0 0 11 e.png\n\n6 1 0 0 0 0 0 0 12 "
           "f.png\n\n";
}

std::string cameras_binary() {
    Bytes file;
    file.put(uint64_t{3});
    file.put(uint32_t{1}).put(int32_t{1}).put(uint64_t{64}).put(uint64_t{48}).put(60.0).put(61.0).put(32.0).put(24.0);
    file.put(uint32_t{7}).put(int32_t{0}).put(uint64_t{10}).put(uint64_t{20}).put(9.5).put(5.0).put(10.0);
    file.put(uint32_t{9}).put(int32_t{2}).put(uint64_t{9}).put(uint64_t{8}).put(7.0).put(5.0).put(4.0).put(-0.06);
    return file.text;
}

std::string images_binary() {
    Bytes file;
    file.put(uint64_t{3});
    for (const uint32_t id : {1u, 2u, 3u}) {
        file.put(id);
        for (const double v : {0.5, 0.5, -0.5, 0.5, 0.0, 1.0, 2.0}) file.put(v);
        file.put(id == 1 ? 1u : id == 2 ? 7u : 9u);
        file.text += id == 1 ? "a.png" : id == 2 ? "sub/b c.png" : "c.png";
        file.put('\0').put(uint64_t{id - 1});
        for (uint32_t point = 1; point < id; ++point) file.put(1.0).put(2.0).put(int64_t{-1});
    }
    return file.text;
}

Target target(const char* name, const char* file, std::vector<std::pair<const char*, std::string>> others,
              const std::string& seed) {
    const auto seeds = [=](const fs::path& folder) {
        for (const auto& [other, text] : others) put_bytes(folder / other, text);
        return std::vector<std::string>{seed};
    };
    return {name, file, seeds, [](const fs::path& folder) {
                for (const CalibratedImage& image : read_colmap(folder, Lenses::taken).images) try_lens(image);
            }};
}

}  // namespace

std::vector<Target> colmap_targets() {
    return {target("colmap_cameras_text", "cameras.txt", {{"images.txt", images_text()}}, cameras_text()),
            target("colmap_images_text", "images.txt", {{"cameras.txt", cameras_text()}}, images_text()),
            target("colmap_cameras_binary", "cameras.bin", {{"images.bin", images_binary()}}, cameras_binary()),
            target("colmap_images_binary", "images.bin", {{"cameras.bin", cameras_binary()}}, images_binary())};
}

}  // namespace radiafit::fuzz
