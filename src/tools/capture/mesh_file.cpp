#include "capture/mesh_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <unordered_map>

#include "base/error.h"
#include "base/read_file.h"
#include "capture/file_names.h"
#include "capture/obj_mesh.h"
#include "capture/ply_header.h"
#include "capture/ply_mesh.h"

namespace radiafit::tools {
namespace {

using Bits = std::array<uint32_t, 3>;

struct BitsHash {
    size_t operator()(const Bits& bits) const {
        uint64_t h = 0;
        for (const uint32_t b : bits) {
            h = (h ^ b) * 0x9e3779b97f4a7c15ull;
            h ^= h >> 29;
        }
        return h;
    }
};

/// PLY by its first line, OBJ, which has no mark, by the name's ending.
RawMesh read_any(const std::filesystem::path& file) {
    std::string content = read_file(file, "mesh file");
    if (content.empty())
        throw UserError(fmt::format("{}: empty mesh: the file has no bytes: export it again", file.string()));
    if (is_ply(content)) return read_ply_mesh(file, std::move(content));
    if (lower_ending(file) == ".obj") return read_obj_mesh(file, std::move(content));
    throw UserError(fmt::format("{}: neither PLY nor OBJ: export the mesh as PLY or OBJ", file.string()));
}

}  // namespace

size_t weld_positions(Mesh& mesh) {
    std::unordered_map<Bits, uint32_t, BitsHash> seen;
    seen.reserve(mesh.positions.size());
    std::vector<uint32_t> new_index(mesh.positions.size());
    std::vector<Vec3f> welded;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const Vec3f p = mesh.positions[v] + Vec3f::Zero();  // -0 + 0 = 0
        const Bits bits{std::bit_cast<uint32_t>(p.x()), std::bit_cast<uint32_t>(p.y()), std::bit_cast<uint32_t>(p.z())};
        const auto [entry, added] = seen.try_emplace(bits, static_cast<uint32_t>(welded.size()));
        if (added) welded.push_back(p);
        new_index[v] = entry->second;
    }
    for (auto& triangle : mesh.triangles)
        for (uint32_t& v : triangle) v = new_index[v];
    const size_t merged = mesh.positions.size() - welded.size();
    mesh.positions = std::move(welded);
    return merged;
}

MeshFile read_mesh_file(const std::filesystem::path& file) {
    const std::string name = file.string();
    RawMesh raw = read_any(file);
    if (raw.mesh.triangles.empty())
        throw UserError(fmt::format("{}: empty mesh: no triangle in it (a point cloud?): export the surface", name));
    check_mesh(raw.mesh, name);
    weld_positions(raw.mesh);

    MeshFile result{std::move(raw.mesh), {}};
    const MeshDefects defects = find_defects(result.mesh);
    const auto note = [&](size_t count, const char* what) {
        if (count) result.notes.push_back(fmt::format("{}: {} {}", name, count, what));
    };
    note(raw.no_polygons, "points or lines left out");
    note(raw.unused_vertices, "vertices of no face left out");
    note(defects.degenerate_triangles.size(), "degenerate triangles, skipped everywhere");
    note(defects.unreferenced_vertices.size(), "vertices of no triangle, which stay without samples");
    if (defects.degenerate_triangles.size() == result.mesh.triangle_count())
        throw UserError(fmt::format("{}: empty mesh: every triangle is degenerate: export the surface again", name));
    return result;
}

}  // namespace radiafit::tools
