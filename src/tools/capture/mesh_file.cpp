#include "capture/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "base/error.h"
#include "base/read_file.h"
#include "base/text_file.h"
#include "capture/file_names.h"
#include "capture/gltf_mesh.h"
#include "capture/obj_mesh.h"
#include "capture/ply_header.h"
#include "capture/ply_mesh.h"
#include "capture/stl_mesh.h"

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

/// Whether an editor, or a tool of another system, saved a PLY of text other than is usual.
bool is_unusual_ply_text(std::string_view content) {
    using namespace std::string_view_literals;
    for (const std::string_view begin : {"\xef\xbb\xbf"sv, "\xff\xfe"sv, "\xfe\xff"sv, "p\0l\0y\0"sv, "\0p\0l\0y"sv})
        if (content.starts_with(begin)) return true;
    return content.starts_with("ply\r") && content.find('\n') == std::string_view::npos;
}

RawMesh read_any(const std::filesystem::path& file) {
    std::string content = read_file(file, "mesh file");
    if (content.empty())
        throw UserError(fmt::format("{}: empty mesh: the file has no bytes: export it again", file.string()));
    const std::string ending = lower_ending(file);
    if (ending == ".ply" && is_unusual_ply_text(content)) content = plain_text(std::move(content), file);
    if (is_ply(content)) return read_ply_mesh(file, std::move(content));
    if (content.starts_with("glTF") || ending == ".gltf") return read_gltf_mesh(file, std::move(content));
    if (ending == ".obj") return read_obj_mesh(file, std::move(content));
    if (ending == ".stl") return read_stl_mesh(file, std::move(content));
    throw UserError(
        fmt::format("{}: neither PLY, OBJ, STL, GLB nor glTF: export the mesh as one of them, PLY or GLB "
                    "best",
                    file.string()));
}

/// Spelled out, since placing must not change a bit of coordinates that stay where they are.
std::vector<Vec3d> place(std::vector<Vec3d> positions, const MeshPlacement& placement) {
    if (!placement.is_identity())
        for (Vec3d& p : positions) p = placement.apply(p);
    return positions;
}

/// Where the origin goes; zero where it stays.
Vec3d choose_origin(const std::vector<Vec3d>& positions, double coarsest_step) {
    Vec3d low = positions.front(), high = positions.front();
    for (const Vec3d& p : positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double extent = (high - low).maxCoeff();
    const double step = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()) * 0x1p-23;
    if (!(extent > 0 && step > coarsest_step * extent)) return Vec3d::Zero();
    const double unit = std::pow(10.0, std::floor(std::log10(extent)));  // so that it is told in few digits
    const Vec3d centre = 0.5 * (low + high) / unit;
    return unit * Vec3d(std::round(centre.x()), std::round(centre.y()), std::round(centre.z()));
}

void require_surface(const RawMesh& raw, const std::string& name) {
    if (!raw.triangles.empty()) return;
    if (raw.positions.empty() && raw.unused_vertices == 0)
        throw UserError(fmt::format("{}: empty mesh: no triangle in it: export the surface", name));
    throw UserError(
        fmt::format("{}: empty mesh: {} points and no triangle, a point cloud: make a surface of it, as Poisson "
                    "reconstruction does (MeshLab, CloudCompare, `colmap poisson_mesher`)",
                    name, raw.positions.size() + raw.unused_vertices));
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

Orientation find_orientation(const Mesh& mesh) {
    const auto key = [](uint32_t from, uint32_t to) { return uint64_t(std::min(from, to)) << 32 | std::max(from, to); };
    struct Edge {
        int forth = 0, back = 0;
    };
    std::unordered_map<uint64_t, Edge> edges;
    edges.reserve(mesh.triangles.size() * 3 / 2 + 1);
    Orientation orientation;
    Vec3d centre = Vec3d::Zero();
    for (const Vec3f& p : mesh.positions) centre += p.cast<double>() / double(mesh.positions.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (is_degenerate(mesh, t)) continue;
        const auto& corners = mesh.triangles[t];
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t from = corners[k], to = corners[(k + 1) % 3];
            Edge& edge = edges[key(from, to)];
            ++(from < to ? edge.forth : edge.back);
        }
        const auto corner = [&](size_t k) -> Vec3d { return mesh.positions[corners[k]].cast<double>() - centre; };
        orientation.signed_volume += corner(0).dot(corner(1).cross(corner(2))) / 6;
    }
    for (const auto& [ends, edge] : edges) {
        if (edge.forth + edge.back == 1) ++orientation.border_edges;
        if (edge.forth + edge.back == 2 && edge.forth != edge.back) ++orientation.disagreeing_edges;
        if (edge.forth + edge.back > 2) ++orientation.crowded_edges;
    }
    orientation.closed = !edges.empty() && orientation.border_edges + orientation.disagreeing_edges == 0 &&
                         orientation.crowded_edges == 0;
    return orientation;
}

MeshFile read_mesh_file(const std::filesystem::path& file, const MeshPlacement& placement, Origin origin) {
    const std::string name = file.string();
    RawMesh raw = read_any(file);
    require_surface(raw, name);
    const std::vector<Vec3d> placed = place(std::move(raw.positions), placement);
    MeshFile result;
    if (placed.empty()) throw UserError(fmt::format("{}: empty mesh: it has no vertices: export it again", name));
    constexpr double coarsest_step = 1e-5, unusable_step = 1e-2;  // of the mesh's extent
    if (origin == Origin::moved)
        result.origin = choose_origin(placed, coarsest_step);
    else if (const Vec3d wanted = choose_origin(placed, unusable_step); !wanted.isZero(0))
        throw UserError(
            fmt::format("{}: so far from the origin, at ({:.10g}, {:.10g}, {:.10g}), that 32-bit floats do not resolve "
                        "it: move mesh and model to the origin",
                        name, wanted.x(), wanted.y(), wanted.z()));
    Mesh& mesh = result.mesh;
    mesh.triangles = std::move(raw.triangles);
    mesh.positions.reserve(placed.size());
    for (const Vec3d& p : placed)
        mesh.positions.push_back((result.origin.isZero(0) ? p : Vec3d(p - result.origin)).cast<float>());
    if (placement.turns_faces())
        for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    check_mesh(mesh, name);
    weld_positions(mesh);

    const MeshDefects defects = find_defects(mesh);
    const auto note = [&](size_t count, const char* what) {
        if (count) result.notes.push_back(fmt::format("{}: {} {}", name, count, what));
    };
    if (!result.origin.isZero(0))
        result.notes.push_back(
            fmt::format("{}: too far from the origin for 32-bit floats: ({:.10g}, {:.10g}, "
                        "{:.10g}) becomes the origin, of mesh and cameras alike",
                        name, result.origin.x(), result.origin.y(), result.origin.z()));
    note(raw.no_polygons, "points or lines left out");
    note(raw.unused_vertices, "vertices of no face left out");
    note(raw.unsound_polygons,
         "polygons that cross themselves or have no area, cut into triangles around their first corner");
    note(defects.degenerate_triangles.size(), "degenerate triangles, skipped everywhere");
    note(defects.unreferenced_vertices.size(), "vertices of no triangle, which stay without samples");
    if (defects.degenerate_triangles.size() == mesh.triangle_count())
        throw UserError(fmt::format("{}: empty mesh: every triangle is degenerate: export the surface again", name));
    result.orientation = find_orientation(mesh);
    note(result.orientation.disagreeing_edges,
         "edges whose two faces are turned against each other: make the faces' orientation coherent (MeshLab: "
         "Re-Orient all faces coherently)");
    for (const std::string& remark : raw.remarks) result.remarks.push_back(fmt::format("{}: {}", name, remark));
    return result;
}

}  // namespace radiafit::tools
