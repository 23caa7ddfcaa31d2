// Meshes of captures.
#include "capture/mesh_file.h"
#include "capture_fixture.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

constexpr const char* ascii_ply =
    "ply\nformat ascii 1.0\ncomment four corners\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property double z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0 1\n1 0 0 2\n1 1e0 0.5 3\n0 1 -0 4\n3 0 1 2\n4 0 1 2 3\n";

template <class T>
T turned(T value, bool turn) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof raw);
    if (turn) std::reverse(raw, raw + sizeof raw);
    std::memcpy(&value, raw, sizeof raw);
    return value;
}

std::string binary_ply(bool big) {
    testing::Bytes file;
    file.text = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                "property float nx\nelement face 2\nproperty list uchar uint vertex_indices\n"
                "property uchar flags\nend_header\n";
    for (int v = 0; v < 4; ++v)
        for (const float x : {float(v % 2), float(v / 2), 0.5f, 1.0f}) file.put(turned(x, big));
    for (const uint32_t last : {2u, 3u}) {
        file.put(uint8_t{3});
        for (const uint32_t index : {0u, 1u, last}) file.put(turned(index, big));
        file.put(uint8_t{9});
    }
    return file.text;
}

Target target(const char* name, const char* file, std::vector<std::string> seeds) {
    return {name, file, [=](const fs::path&) { return seeds; },
            [=](const fs::path& folder) { read_mesh_file(folder / file); }};
}

}  // namespace

std::vector<Target> mesh_targets() {
    return {target("mesh_ply", "mesh.ply", {ascii_ply, binary_ply(false), binary_ply(true)}),
            target("mesh_obj", "mesh.obj",
                   {"# square\nmtllib none.mtl\no a\nv -0.5 -0.5 2\nv 0.5 -0.5 2 1\nv 0.5 5e-1 2\nv -0.5 0.5 2\n"
                    "vt 0 0\nvn 0 0 1\ng b\nusemtl c\ns off\nf 1/1/1 4/1/1 3/1/1 2/1/1\nf -1 -2 -3\nf 1//1 2//1 3//1\n",
                    "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1/ 2 \\\n3\nl 1 2\np 3\n"})};
}

}  // namespace radiafit::fuzz
