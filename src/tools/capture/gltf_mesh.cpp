#include "capture/gltf_mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/json.h"
#include "base/read_file.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;
static_assert(std::endian::native == std::endian::little, "little-endian files are read as they are");

/// Numbers of glTF 2.0's specification.
enum Component { signed_byte = 5120, unsigned_byte, signed_short, unsigned_short, unsigned_int = 5125, real_number };
enum Mode { separate_triangles = 4, triangle_strip, triangle_fan };

std::optional<std::string> from_base64(std::string_view text) {
    std::string bytes;
    uint32_t bits = 0;
    int count = 0;
    while (text.ends_with('=')) text.remove_suffix(1);
    for (const char c : text) {
        const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                          : c >= 'a' && c <= 'z' ? c - 'a' + 26
                          : c >= '0' && c <= '9' ? c - '0' + 52
                          : c == '+'             ? 62
                          : c == '/'             ? 63
                                                 : -1;
        if (value < 0) return {};
        bits = bits << 6 | uint32_t(value);
        count += 6;
        if (count >= 8) bytes.push_back(char(bits >> (count -= 8) & 0xff));
    }
    return bytes;
}

/// A relative URI's path: %20 is a blank.
std::string from_uri(std::string_view uri) {
    std::string path;
    const auto digit = [](char c) {
        return c >= '0' && c <= '9' ? c - '0' : (c | 0x20) >= 'a' && (c | 0x20) <= 'f' ? (c | 0x20) - 'a' + 10 : -1;
    };
    for (size_t k = 0; k < uri.size(); ++k) {
        const bool coded = uri[k] == '%' && k + 2 < uri.size() && digit(uri[k + 1]) >= 0 && digit(uri[k + 2]) >= 0;
        path.push_back(coded ? char(digit(uri[k + 1]) * 16 + digit(uri[k + 2])) : uri[k]);
        if (coded) k += 2;
    }
    return path;
}

struct Transform {
    Mat3d linear = Mat3d::Identity();
    Vec3d shift = Vec3d::Zero();
};

/// A list of numbers within a buffer, checked to lie there.
struct Accessor {
    std::string_view bytes;  ///< from its first number on
    uint64_t count = 0, stride = 0;
    int component = 0;
    bool normalized = false;

    double number(uint64_t index, uint64_t part) const {
        const char* from = bytes.data() + index * stride;
        const auto take = [&]<class T>(T value, double largest) {
            std::memcpy(&value, from + part * sizeof(T), sizeof(T));
            return normalized ? std::max(double(value) / largest, -1.0) : double(value);
        };
        switch (component) {
            case signed_byte:
                return take(int8_t{}, 127);
            case unsigned_byte:
                return take(uint8_t{}, 255);
            case signed_short:
                return take(int16_t{}, 32767);
            case unsigned_short:
                return take(uint16_t{}, 65535);
            case unsigned_int:
                return take(uint32_t{}, 1);
            default:
                return take(float{}, 1);
        }
    }
};

class GltfReader {
public:
    GltfReader(const fs::path& file, std::string content) : file_(file), content_(std::move(content)) {}

    RawMesh read() {
        const std::string_view text = content_.starts_with("glTF") ? split_glb() : std::string_view(content_);
        gltf_ = parse_json<Json>(text);
        if (!gltf_.is_object()) fail("no glTF in it, or a damaged one: export the mesh again, as GLB, PLY, OBJ or STL");
        try {
            read_scene();
        } catch (const Json::exception&) {
            fail("malformed glTF, a value is missing or of another type: export the mesh again");
        }
        raw_.remarks.push_back("glTF has y up: its positions are taken as they are");
        return std::move(raw_);
    }

private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw UserError(fmt::format("{}: {}", file_.string(), problem));
    }

    /// Returns the JSON text; finds the binary chunk.
    std::string_view split_glb() {
        const std::string_view all = content_;
        const auto number = [&](size_t at) {
            uint32_t value = 0;
            std::memcpy(&value, all.data() + at, sizeof value);
            return value;
        };
        if (all.size() < 20 || number(8) > all.size()) fail("the GLB file is cut: copy or export the mesh again");
        if (number(4) != 2) fail(fmt::format("GLB of version {}, not 2: export the mesh again", number(4)));
        constexpr uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
        const uint64_t json_bytes = number(12);
        if (number(16) != json_chunk || json_bytes > all.size() - 20)
            fail("malformed GLB: its JSON chunk is not whole: export the mesh again");
        const uint64_t next = 20 + json_bytes;
        if (next + 8 <= all.size() && number(next + 4) == binary_chunk) {
            if (number(next) > all.size() - next - 8)
                fail("malformed GLB: its binary chunk is not whole: copy or export the mesh again");
            binary_ = all.substr(next + 8, number(next));
        }
        return all.substr(20, json_bytes);
    }

    /// The entry of a list at the top of the file.
    const Json& entry(const char* list, uint64_t index) const {
        const auto found = gltf_.find(list);
        if (found == gltf_.end() || !found->is_array() || index >= found->size())
            fail(fmt::format("malformed glTF: there is no entry {} of '{}': export the mesh again", index, list));
        return (*found)[index];
    }
    static uint64_t natural(const Json& object, const char* name, std::optional<uint64_t> otherwise = {}) {
        if (otherwise && !object.contains(name)) return *otherwise;
        const Json& value = object.at(name);
        if (!value.is_number_unsigned()) throw Json::type_error::create(302, "no natural number", &value);
        return value.get<uint64_t>();
    }
    size_t size_of(const char* list) const {
        const auto found = gltf_.find(list);
        return found == gltf_.end() ? 0 : found->size();
    }

    void read_scene() {
        check_extensions();
        load_buffers();
        visited_.assign(size_of("nodes"), 0);
        if (size_of("scenes")) {
            const Json& scene = entry("scenes", natural(gltf_, "scene", 0));
            if (scene.contains("nodes"))
                for (const Json& node : scene.at("nodes")) read_node(node.get<uint64_t>(), {}, 0);
        } else {
            for (size_t mesh = 0; mesh < size_of("meshes"); ++mesh) read_mesh(mesh, {});
        }
    }

    void refuse_compressed(std::string_view extension) const {
        if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression" ||
            extension == "KHR_meshopt_compression")
            fail(fmt::format("compressed by {}: export the mesh without compression", extension));
    }
    void check_extensions() const {
        if (!gltf_.contains("extensionsRequired")) return;
        for (const Json& value : gltf_.at("extensionsRequired")) {
            const auto name = value.get<std::string>();
            refuse_compressed(name);
            const bool look = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
                              name.starts_with("EXT_texture_") || name.starts_with("KHR_lights_");
            if (!look && name != "KHR_mesh_quantization")
                fail(fmt::format("requires the extension {}, which is not read: export the mesh without it, or as PLY",
                                 name));
        }
    }

    void load_buffers() {
        constexpr size_t most_buffers = 64;
        if (size_of("buffers") > most_buffers)
            fail(fmt::format("has {} buffers, more than {}: export the mesh as GLB", size_of("buffers"), most_buffers));
        for (size_t k = 0; k < size_of("buffers"); ++k) {
            const Json& buffer = entry("buffers", k);
            const uint64_t bytes = natural(buffer, "byteLength");
            std::string loaded;
            const bool beside = buffer.contains("uri");
            if (beside) {
                const auto uri = buffer.at("uri").get<std::string>();
                const size_t comma = uri.find(";base64,");
                if (uri.starts_with("data:")) {
                    auto decoded = comma == std::string::npos ? std::nullopt
                                                              : from_base64(std::string_view(uri).substr(comma + 8));
                    if (!decoded) fail(fmt::format("buffer {} is no base64: export the mesh again", k));
                    loaded = std::move(*decoded);
                } else {
                    const fs::path path = from_uri(uri);
                    if (uri.find("://") != std::string::npos || path.is_absolute())
                        fail(fmt::format("buffer {} is not beside the file but at {}: export the mesh as GLB", k, uri));
                    loaded = read_file(file_.parent_path() / path, "buffer of a glTF file");
                }
            }
            loaded_.push_back(std::move(loaded));
            sources_.push_back(beside);
            const uint64_t there = beside ? loaded_.back().size() : k == 0 ? binary_.size() : 0;
            if (bytes > there)
                fail(fmt::format("buffer {} has {} of its {} bytes: copy or export the mesh again", k, there, bytes));
            if (beside) loaded_.back().resize(bytes), loaded_.back().shrink_to_fit();
            total_bytes_ += bytes;
            lengths_.push_back(bytes);
        }
    }
    std::string_view buffer(uint64_t index) const {
        if (index >= lengths_.size())
            fail(fmt::format("malformed glTF: there is no buffer {}: export it again", index));
        return (sources_[index] ? std::string_view(loaded_[index]) : binary_).substr(0, lengths_[index]);
    }

    void read_node(uint64_t index, const Transform& parent, int depth) {
        const Json& node = entry("nodes", index);
        if (visited_[index] || depth > 200)
            fail(fmt::format("malformed glTF: node {} is below two others, or too deep: export the mesh again", index));
        visited_[index] = 1;
        const Transform own = transform_of(node);
        const Transform world = {parent.linear * own.linear, parent.linear * own.shift + parent.shift};
        if (node.contains("mesh")) read_mesh(natural(node, "mesh"), world);
        if (node.contains("children"))
            for (const Json& child : node.at("children")) read_node(child.get<uint64_t>(), world, depth + 1);
    }

    template <size_t n>
    static std::array<double, n> numbers(const Json& list) {
        std::array<double, n> result;
        if (!list.is_array() || list.size() != n) throw Json::type_error::create(302, "another length", &list);
        for (size_t k = 0; k < n; ++k) result[k] = list[k].get<double>();
        return result;
    }
    static Transform transform_of(const Json& node) {
        Transform t;
        if (node.contains("matrix")) {
            const auto m = numbers<16>(node.at("matrix"));  // by columns
            for (int column = 0; column < 3; ++column)
                for (int row = 0; row < 3; ++row) t.linear(row, column) = m[size_t(column * 4 + row)];
            t.shift = {m[12], m[13], m[14]};
            return t;
        }
        if (node.contains("rotation")) {
            const auto q = numbers<4>(node.at("rotation"));  // x, y, z, w
            t.linear = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
        }
        if (node.contains("scale")) {
            const auto s = numbers<3>(node.at("scale"));
            for (int column = 0; column < 3; ++column) t.linear.col(column) *= s[size_t(column)];
        }
        if (node.contains("translation")) {
            const auto s = numbers<3>(node.at("translation"));
            t.shift = {s[0], s[1], s[2]};
        }
        return t;
    }

    void read_mesh(uint64_t index, const Transform& transform) {
        const Json& mesh = entry("meshes", index);
        first_vertices_.clear();
        for (const Json& primitive : mesh.at("primitives")) {
            if (primitive.contains("extensions"))
                for (const auto& [name, value] : primitive.at("extensions").items()) refuse_compressed(name);
            read_primitive(primitive, transform, fmt::format("mesh {}", index));
        }
    }

    void read_primitive(const Json& primitive, const Transform& transform, const std::string& where) {
        const uint64_t mode = natural(primitive, "mode", separate_triangles);
        if (mode < separate_triangles) {
            ++raw_.no_polygons;
            return;
        }
        if (mode > triangle_fan) fail(fmt::format("{}: malformed glTF: its mode is {}: export it again", where, mode));
        if (!primitive.at("attributes").contains("POSITION")) return;
        const uint64_t position_index = natural(primitive.at("attributes"), "POSITION");
        const Accessor positions = accessor(position_index, "VEC3", 3, where);
        std::optional<Accessor> indices;
        if (primitive.contains("indices")) {
            indices = accessor(natural(primitive, "indices"), "SCALAR", 1, where);
            if (indices->component != unsigned_byte && indices->component != unsigned_short &&
                indices->component != unsigned_int)
                fail(fmt::format("{}: malformed glTF: its indices are no natural numbers: export it again", where));
        }
        const uint64_t corner_count = indices ? indices->count : positions.count;
        // Many nodes may show one mesh, so that a small file makes vast ones.
        const auto [entry, is_new] =
            first_vertices_.try_emplace(position_index, static_cast<uint32_t>(raw_.positions.size()));
        taken_ += (is_new ? positions.count : 0) + corner_count;
        if (taken_ > 10000000 + total_bytes_ || raw_.positions.size() + positions.count > 0xffffffffu)
            fail(
                "its nodes and primitives take so many vertices, again and again, that they do not fit: join the "
                "meshes, or export them as PLY");

        const uint32_t first = entry->second;
        for (uint64_t v = 0; is_new && v < positions.count; ++v) {
            const Vec3d p(positions.number(v, 0), positions.number(v, 1), positions.number(v, 2));
            const Vec3d placed = transform.linear * p + transform.shift;
            if (!placed.cast<float>().allFinite())
                fail(fmt::format("{}, vertex {}: its position is not finite: repair the mesh", where, v));
            raw_.positions.push_back(placed);
        }
        std::vector<uint32_t> corners;
        corners.reserve(corner_count);
        for (uint64_t k = 0; k < corner_count; ++k) {
            const auto index = indices ? static_cast<uint64_t>(indices->number(k, 0)) : k;
            if (index >= positions.count)
                fail(fmt::format("{}: refers to vertex {}, but they are numbered from 0 to below {}: export it again",
                                 where, index, positions.count));
            corners.push_back(first + static_cast<uint32_t>(index));
        }
        add_triangles(corners, mode, transform.linear.determinant() < 0, where);
    }

    void add_triangles(const std::vector<uint32_t>& corners, uint64_t mode, bool mirrored, const std::string& where) {
        const size_t before = raw_.triangles.size();
        if (mode == separate_triangles) {
            if (corners.size() % 3)
                fail(fmt::format("{}: {} corners are no triangles: export it again", where, corners.size()));
            for (size_t k = 0; k < corners.size(); k += 3)
                raw_.triangles.push_back({corners[k], corners[k + 1], corners[k + 2]});
        } else if (mode == triangle_strip) {
            raw_.add_strip(corners);
        } else {
            for (size_t k = 2; k < corners.size(); ++k)
                raw_.triangles.push_back({corners[0], corners[k - 1], corners[k]});
        }
        if (mirrored)
            for (size_t t = before; t < raw_.triangles.size(); ++t)
                std::swap(raw_.triangles[t][1], raw_.triangles[t][2]);
    }

    Accessor accessor(uint64_t index, const char* type, uint64_t parts, const std::string& where) const {
        const Json& given = entry("accessors", index);
        const auto bad = [&](const char* what) {
            fail(fmt::format("{}, accessor {}: {}: export the mesh again", where, index, what));
        };
        if (given.contains("sparse")) bad("sparse, which is not read");
        if (given.at("type").get<std::string>() != type) bad("of another type than it is used for");
        if (!given.contains("bufferView")) bad("names no bytes");
        Accessor result;
        result.count = natural(given, "count");
        const uint64_t component = natural(given, "componentType");
        const uint64_t bytes = component == signed_byte || component == unsigned_byte     ? 1
                               : component == signed_short || component == unsigned_short ? 2
                               : component == unsigned_int || component == real_number    ? 4
                                                                                          : 0;
        if (bytes == 0) bad("malformed glTF, of an unknown type of number");
        result.component = int(component);
        result.normalized = given.value("normalized", false) && component < unsigned_int;

        const Json& view = entry("bufferViews", natural(given, "bufferView"));
        if (view.contains("extensions"))
            for (const auto& [name, value] : view.at("extensions").items()) refuse_compressed(name);
        const std::string_view all = buffer(natural(view, "buffer"));
        const uint64_t view_at = natural(view, "byteOffset", 0), view_bytes = natural(view, "byteLength");
        if (view_at > all.size() || view_bytes > all.size() - view_at) bad("its bytes lie outside of the buffer");
        const uint64_t at = natural(given, "byteOffset", 0), size = parts * bytes;
        result.stride = natural(view, "byteStride", size);
        if (result.stride < size || result.stride > 252) bad("malformed glTF, its stride does not fit");
        if (result.count == 0) return result;
        if (at > view_bytes || size > view_bytes - at || result.count - 1 > (view_bytes - at - size) / result.stride)
            bad("has more numbers than bytes");
        result.bytes = all.substr(view_at + at, view_bytes - at);
        return result;
    }

    fs::path file_;
    std::string content_;
    Json gltf_;
    std::string_view binary_;          ///< chunk of a GLB file
    std::vector<std::string> loaded_;  ///< buffers that are not in it
    std::vector<bool> sources_;        ///< of each buffer, whether it is loaded
    std::vector<uint64_t> lengths_;    ///< of each buffer
    std::vector<uint8_t> visited_;     ///< nodes
    /// Of this mesh in this place, by accessor: its primitives share vertices.
    std::map<uint64_t, uint32_t> first_vertices_;
    uint64_t total_bytes_ = 0, taken_ = 0;
    RawMesh raw_;
};

}  // namespace

RawMesh read_gltf_mesh(const fs::path& file, std::string content) {
    return GltfReader(file, std::move(content)).read();
}

}  // namespace radiafit::tools
