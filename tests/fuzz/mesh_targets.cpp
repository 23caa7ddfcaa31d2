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

/// Two triangles as STL has them: a name of 80 bytes, their number, then normal, corners and two bytes each.
std::string binary_stl() {
    testing::Bytes file;
    file.text = std::string(80, ' ');
    file.put(uint32_t{2});
    for (const float z : {0.0f, 1.0f}) {
        for (const float x : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, z, 1.0f, 0.0f, z, 0.0f, 1.0f, 0.5f}) file.put(x);
        file.put(uint16_t{0});
    }
    return file.text;
}
constexpr const char* text_stl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid a\n";

constexpr const char* ply_of_strips =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
    "8 0 1 2 3 -1 0 1 2\n";

/// A scene of two nodes that show one triangle, its buffer `uri` or in the GLB itself.
std::string gltf_scene(const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"scale":[2,2,2]},)"
           R"({"mesh":0,"translation":[1,0,0],"rotation":[0,0,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
           R"("indices":1,"mode":4}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
           R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36},)"
           R"({"buffer":0,"byteOffset":36,"byteLength":6}],"buffers":[{"byteLength":42)" +
           (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}]}";
}
std::string glb() {
    testing::Bytes corners;
    for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) corners.put(x);
    for (const uint16_t k : {0, 1, 2}) corners.put(k);
    corners.text.resize(44);  // a multiple of four
    std::string json = gltf_scene("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    testing::Bytes file;
    file.text = "glTF";
    file.put(uint32_t{2}).put(uint32_t(12 + 8 + json.size() + 8 + corners.text.size()));
    file.put(uint32_t(json.size())).text += "JSON" + json;
    file.put(uint32_t(corners.text.size())).text += std::string("BIN\0", 4) + corners.text;
    return file.text;
}

Target target(const char* name, const char* file, std::vector<std::string> seeds) {
    return {name, file, [=](const fs::path&) { return seeds; },
            [=](const fs::path& folder) { read_mesh_file(folder / file); }};
}

}  // namespace

std::vector<Target> mesh_targets() {
    return {
        target("mesh_ply", "mesh.ply", {ascii_ply, binary_ply(false), binary_ply(true), ply_of_strips}),
        target("mesh_obj", "mesh.obj",
               {"# square\nmtllib none.mtl\no a\nv -0.5 -0.5 2\nv 0.5 -0.5 2 1\nv 0.5 5e-1 2\nv -0.5 0.5 2\n"
                "vt 0 0\nvn 0 0 1\ng b\nusemtl c\ns off\nf 1/1/1 4/1/1 3/1/1 2/1/1\nf -1 -2 -3\nf 1//1 2//1 3//1\n",
                "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1/ 2 \\\n3\nl 1 2\np 3\n",
                "\xef\xbb\xbfv 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1 # concave\nf 1 2 3"}),
        target("mesh_stl", "mesh.stl", {binary_stl(), text_stl}), target("mesh_glb", "mesh.glb", {glb()}),
        target("mesh_gltf", "mesh.gltf",
               {gltf_scene(
                   "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA")})};
}

}  // namespace radiafit::fuzz
