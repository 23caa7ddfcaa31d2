#include "exchange/gltf.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "base/error.h"
#include "base/json.h"
#include "base/output_claims.h"
#include "base/record.h"
#include "base/wording.h"
#include "eval/turntable.h"
#include "exchange/textures.h"
#include "geometry/shortest_turn.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little);

// Numbers of the glTF 2.0 specification.
constexpr int float_component = 5126, array_buffer = 34962, linear_filter = 9729, clamp_to_edge = 33071;
constexpr uint32_t glb_magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
constexpr uint64_t most_bytes = 0xffffffffu;
constexpr const char* generator = "radiafit";

/// The binary chunk, and what JSON says of it.
class Buffer {
public:
    /// Index of a buffer view of these bytes.
    int add(std::string_view bytes, int target = 0) {
        bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
        Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
        if (target != 0) view["target"] = target;
        bytes_.append(bytes);
        if (bytes_.size() > most_bytes)
            throw UserError("a glTF file holds 4 GiB at most; choose " + option_name("without-maps"));
        views.push_back(view);
        return int(views.size()) - 1;
    }
    /// Index of an accessor of vectors of `width` floats.
    int add(const std::vector<float>& values, int width, bool bounds = false) {
        const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
        Json accessor = {{"bufferView", add(bytes, array_buffer)},
                         {"componentType", float_component},
                         {"count", values.size() / size_t(width)},
                         {"type", fmt::format("VEC{}", width)}};
        if (bounds) {
            std::vector<float> least(values.begin(), values.begin() + width), most = least;
            for (size_t i = 0; i < values.size(); ++i) {
                const size_t c = i % size_t(width);
                least[c] = std::min(least[c], values[i]);
                most[c] = std::max(most[c], values[i]);
            }
            accessor["min"] = least;
            accessor["max"] = most;
        }
        accessors.push_back(accessor);
        return int(accessors.size()) - 1;
    }
    const std::string& bytes() const { return bytes_; }

    Json views = Json::array(), accessors = Json::array();

private:
    std::string bytes_;
};

struct Vertices {
    std::vector<float> positions, normals, tangents, texture, own_maps;  ///< tangents: of a grid; own_maps: of a mesh
};

void append(const Vec3f& v, std::vector<float>& to) { to.insert(to.end(), v.begin(), v.end()); }

Vertices vertices_of(const Mesh& mesh, const TriangleAtlas& atlas, const LookTextures& textures) {
    Vertices out;
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    const std::array<float, 2> size = {float(textures.base_colour.width), float(textures.base_colour.height)};
    const std::array<float, 2> own_size = {float(atlas.width()), float(atlas.height())};
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (atlas.degenerate(t)) continue;
        const auto padded = textures.tiles->corners(t), own = atlas_corners(atlas, t);
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t vertex = mesh.triangles[t][corner];
            append(mesh.positions[vertex], out.positions);
            append(normals[vertex].normalized(), out.normals);
            for (size_t c = 0; c < 2; ++c) {
                out.texture.push_back(padded[corner][c] / size[c]);
                out.own_maps.push_back(own[corner][c] / own_size[c]);
            }
        }
    }
    return out;
}

Vertices vertices_of(const Grid& grid) {
    Vertices out;
    const Vec3f right = grid.right.normalized().cast<float>();
    const auto corner = [&](float u, float v) {
        append(grid.position(0, 0).cast<float>() + (u * float(grid.width) - 0.5f) * grid.right.cast<float>() +
                   (v * float(grid.height) - 0.5f) * grid.down.cast<float>(),
               out.positions);
        append(grid.normal().cast<float>(), out.normals);
        append(right, out.tangents);
        out.tangents.push_back(1);
        out.texture.insert(out.texture.end(), {u, v});
    };
    for (const auto& [u, v] : {std::pair{0.0f, 0.0f}, {0.0f, 1.0f}, {1.0f, 1.0f}}) corner(u, v);
    for (const auto& [u, v] : {std::pair{0.0f, 0.0f}, {1.0f, 1.0f}, {1.0f, 0.0f}}) corner(u, v);
    return out;
}

/// Turns what is up in the photographs to +y; x, y, z, w.
std::array<double, 4> upright(const Dataset& dataset) {
    const Vec3d up = dataset.has_grid() ? Vec3d(-dataset.grid.down.normalized()) : up_of(dataset.views);
    const auto turn = shortest_turn(up, Vec3d::UnitY());
    return {turn.x(), turn.y(), turn.z(), turn.w()};
}

void add_image(const std::string& png, const char* name, Buffer& buffer, Json& gltf) {
    gltf["images"].push_back({{"bufferView", buffer.add(png)}, {"mimeType", "image/png"}, {"name", name}});
    gltf["textures"].push_back({{"sampler", 0}, {"source", int(gltf["images"].size()) - 1}});
}

void add_material(const SurfaceLook& look, const LookTextures& textures, Buffer& buffer, Json& gltf) {
    // No mipmaps: they would mix triangles that are neighbours in the texture alone.
    gltf["samplers"] = Json::array({{{"magFilter", linear_filter},
                                     {"minFilter", linear_filter},
                                     {"wrapS", clamp_to_edge},
                                     {"wrapT", clamp_to_edge}}});
    const auto newest = [&] { return Json{{"index", int(gltf["textures"].size()) - 1}}; };
    Json material = {{"name", "fit"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
    Json& pbr = material["pbrMetallicRoughness"];
    add_image(base_colour_png(textures), "base colour", buffer, gltf);
    pbr["baseColorTexture"] = newest();
    if (textures.roughness) {
        add_image(roughness_png(*textures.roughness), "roughness", buffer, gltf);
        pbr["metallicRoughnessTexture"] = newest();
    }
    if (textures.normals) {
        add_image(normals_png(*textures.normals), "normals", buffer, gltf);
        material["normalTexture"] = newest();
    }
    if (textures.base_colour.channels == 4) material["alphaMode"] = "MASK";
    if (!look.albedo && !textures.roughness) {
        gltf["extensionsUsed"] = {"KHR_materials_unlit"};
        material["extensions"]["KHR_materials_unlit"] = Json::object();
    }
    gltf["materials"] = Json::array({material});
}

std::string word(uint32_t x) { return {reinterpret_cast<const char*>(&x), sizeof(x)}; }

std::string glb(const Json& gltf, std::string binary) {
    std::string json = json_text(gltf, -1, NotUtf8::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const uint64_t length = 12 + 8 + uint64_t(json.size()) + 8 + uint64_t(binary.size());
    if (length > most_bytes) throw UserError("a glTF file holds 4 GiB at most; choose " + option_name("without-maps"));
    return word(glb_magic) + word(2) + word(uint32_t(length)) + word(uint32_t(json.size())) + word(json_chunk) + json +
           word(uint32_t(binary.size())) + word(binary_chunk) + binary;
}

}  // namespace

std::string glb_of(const SurfaceLook& look, const Dataset& dataset, const std::string& model,
                   const std::vector<OwnFile>& own) {
    const LookTextures textures = textures_of(look, dataset);
    const Vertices vertices =
        dataset.has_grid() ? vertices_of(dataset.grid)
                           : vertices_of(dataset.mesh, dynamic_cast<const TriangleAtlas&>(*look.atlas), textures);
    Buffer buffer;
    Json gltf = {{"asset", {{"version", "2.0"}, {"generator", fmt::format("{} {}", generator, project_version())}}},
                 {"scene", 0},
                 {"scenes", Json::array({{{"nodes", {0}}}})},
                 {"nodes", Json::array({{{"mesh", 0}, {"name", dataset.name}, {"rotation", upright(dataset)}}})}};
    Json attributes = {{"POSITION", buffer.add(vertices.positions, 3, true)},
                       {"NORMAL", buffer.add(vertices.normals, 3)},
                       {"TEXCOORD_0", buffer.add(vertices.texture, 2)}};
    if (textures.normals) attributes["TANGENT"] = buffer.add(vertices.tangents, 4);
    if (!own.empty() && !vertices.own_maps.empty()) attributes["TEXCOORD_1"] = buffer.add(vertices.own_maps, 2);
    gltf["meshes"] = Json::array(
        {{{"name", dataset.name}, {"primitives", Json::array({{{"attributes", attributes}, {"material", 0}}})}}});
    add_material(look, textures, buffer, gltf);
    Json about = {{"model", model}, {"base_colour", look.meaning}};
    for (const OwnFile& file : own) {
        const char* kind = file.name.ends_with(".json") ? "application/json" : "image/x-exr";
        about["files"].push_back({{"name", file.name}, {"bufferView", buffer.add(file.bytes)}, {"mimeType", kind}});
    }
    if (!own.empty()) about["texCoord"] = vertices.own_maps.empty() ? 0 : 1;
    if (const std::string made = made_by_remark(); !made.empty()) about["made_by"] = made;
    gltf["extras"] = {{"radiafit", about}};
    gltf["accessors"] = buffer.accessors;
    gltf["bufferViews"] = buffer.views;
    gltf["buffers"] = Json::array({{{"byteLength", buffer.bytes().size()}}});
    return glb(gltf, buffer.bytes());
}

bool is_our_glb(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string start(512, '\0');
    stream.read(start.data(), std::streamsize(start.size()));
    start.resize(size_t(stream.gcount()));
    return start.starts_with("glTF") && start.find(fmt::format("\"generator\":\"{} ", generator)) != std::string::npos;
}

}  // namespace radiafit::tools
