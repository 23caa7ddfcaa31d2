#include "capture/colmap.h"
#include "capture_fixture.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

using radiafit::testing::Bytes;

std::string cameras_text() {
    return "# cameras\n1 PINHOLE 64 48 60 61 32 24\n7 SIMPLE_PINHOLE 10 20 9.5 5 10\n8 OPENCV 9 8 7 6 5 4 0 0 -0 0\n";
}
std::string images_text() {
    return "# images\n1 1 0 0 0 0.5 -1e-3 2 1 a.png\n1 2 -1 3.5 4 7\n2 0.5 0.5 -0.5 0.5 0 0 0 7 sub/b c.png\n\n";
}

std::string cameras_binary() {
    Bytes file;
    file.put(uint64_t{2});
    file.put(uint32_t{1}).put(int32_t{1}).put(uint64_t{64}).put(uint64_t{48}).put(60.0).put(61.0).put(32.0).put(24.0);
    file.put(uint32_t{7}).put(int32_t{0}).put(uint64_t{10}).put(uint64_t{20}).put(9.5).put(5.0).put(10.0);
    return file.text;
}

std::string images_binary() {
    Bytes file;
    file.put(uint64_t{2});
    for (const uint32_t id : {1u, 2u}) {
        file.put(id);
        for (const double v : {0.5, 0.5, -0.5, 0.5, 0.0, 1.0, 2.0}) file.put(v);
        file.put(id == 1 ? 1u : 7u);
        file.text += id == 1 ? std::string("a.png") : std::string("sub/b c.png");
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
    return {name, file, seeds, [](const fs::path& folder) { read_colmap(folder); }};
}

}  // namespace

std::vector<Target> colmap_targets() {
    return {target("colmap_cameras_text", "cameras.txt", {{"images.txt", images_text()}}, cameras_text()),
            target("colmap_images_text", "images.txt", {{"cameras.txt", cameras_text()}}, images_text()),
            target("colmap_cameras_binary", "cameras.bin", {{"images.bin", images_binary()}}, cameras_binary()),
            target("colmap_images_binary", "images.bin", {{"cameras.bin", cameras_binary()}}, images_binary())};
}

}  // namespace radiafit::fuzz
