#include "capture/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <bit>
#include <unordered_map>

#include "base/error.h"

namespace radiafit {
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

/// Appends the meshes of a node and of what hangs below it. Returns how many faces were no triangles.
size_t append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, Mesh& out) {
    const aiMatrix4x4 world_from_node = parent * node.mTransformation;
    const bool moved = !world_from_node.IsIdentity();  // untouched positions stay the file's own, bit for bit
    size_t skipped = 0;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
        const auto first = static_cast<uint32_t>(out.positions.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D p = moved ? world_from_node * mesh.mVertices[v] : mesh.mVertices[v];
            out.positions.emplace_back(p.x, p.y, p.z);
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices == 3)
                out.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
            else
                ++skipped;
        }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c)
        skipped += append_node(scene, *node.mChildren[c], world_from_node, out);
    return skipped;
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
    if (!std::filesystem::is_regular_file(file))
        throw UserError(fmt::format("{}: no such mesh file: check the path", name));
    if (std::filesystem::file_size(file) == 0)
        throw UserError(fmt::format("{}: empty mesh: the file has no bytes: export it again", name));

    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
    MeshFile result;
    size_t skipped = 0;
    if (scene != nullptr && scene->mRootNode != nullptr)
        skipped = append_node(*scene, *scene->mRootNode, aiMatrix4x4(), result.mesh);
    else if (std::string why = importer.GetErrorString(); true) {
        for (size_t at; (at = why.find('\n')) != std::string::npos;) why.replace(at, 1, " ");
        throw UserError(fmt::format("{}: cannot read this mesh ({}): export it as OBJ or PLY", name, why));
    }
    if (result.mesh.triangles.empty())
        throw UserError(fmt::format("{}: empty mesh: no triangle in it (a point cloud?): export the surface", name));
    weld_positions(result.mesh);
    check_mesh(result.mesh, name);

    const MeshDefects defects = find_defects(result.mesh);
    const auto note = [&](size_t count, const char* what) {
        if (count) result.notes.push_back(fmt::format("{}: {} {}", name, count, what));
    };
    note(skipped, "points or lines left out");
    note(defects.degenerate_triangles.size(), "degenerate triangles, skipped everywhere");
    note(defects.unreferenced_vertices.size(), "vertices of no triangle, which stay without samples");
    if (defects.degenerate_triangles.size() == result.mesh.triangle_count())
        throw UserError(fmt::format("{}: empty mesh: every triangle is degenerate: export the surface again", name));
    return result;
}

}  // namespace radiafit
