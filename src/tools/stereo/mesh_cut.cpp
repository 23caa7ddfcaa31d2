#include "stereo/mesh_cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "stereo/mesh_border.h"
#include "stereo/vertex_evidence.h"

namespace radiafit::tools {
namespace {

using Marks = std::vector<uint8_t>;  ///< of vertices

/// Marks every vertex that shares a triangle with one that has `mark`, where `allowed`.
void spread(const Mesh& mesh, Marks& marks, uint8_t mark, const Marks& allowed) {
    const Marks before = marks;
    for (const auto& t : mesh.triangles)
        if (before[t[0]] == mark || before[t[1]] == mark || before[t[2]] == mark)
            for (const uint32_t v : t)
                if (allowed[v]) marks[v] = mark;
}

/// Grown by so many rings, then shrunk by as many; never beyond `allowed`, never less than before.
Marks closed(const Mesh& mesh, const Marks& kept, const Marks& allowed, int rings) {
    Marks grown = kept;
    for (int r = 0; r < rings; ++r) spread(mesh, grown, 1, allowed);
    Marks removable(kept.size());
    for (size_t v = 0; v < kept.size(); ++v) removable[v] = !kept[v];
    for (int r = 0; r < rings; ++r) spread(mesh, grown, 0, removable);
    return grown;
}

/// With holes filled: pieces of what is neither kept nor forbidden, of which every vertex has a kept one at most so
/// many rings away, and which kept vertices enclose but for a tenth of the way around; more is open at flaps along an
/// edge.
Marks without_holes(const Mesh& mesh, const Marks& kept, const Marks& allowed, int rings) {
    const size_t count = kept.size();
    std::vector<int> away(count, -1);  // rings to the nearest kept vertex
    for (size_t v = 0; v < count; ++v)
        if (kept[v]) away[v] = 0;
    for (int r = 1; r <= rings; ++r)
        for (const auto& t : mesh.triangles)
            if (std::ranges::any_of(t, [&](uint32_t v) { return away[v] == r - 1; }))
                for (const uint32_t v : t)
                    if (away[v] < 0) away[v] = r;
    const auto in_hole = [&](uint32_t v) { return !kept[v] && allowed[v]; };
    const auto each_edge = [&](const auto& visit) {
        for (const auto& t : mesh.triangles)
            for (size_t k = 0; k < 3; ++k) visit(t[k], t[(k + 1) % 3]);
    };
    std::vector<std::array<uint32_t, 2>> within;
    each_edge([&](uint32_t a, uint32_t b) {
        if (in_hole(a) && in_hole(b)) within.push_back({a, b});
    });
    const std::vector<uint32_t> piece = connected(count, within);
    std::vector<double> closed_edges(count, 0), open_edges(count, 0);
    each_edge([&](uint32_t a, uint32_t b) {
        if (in_hole(a) == in_hole(b)) return;
        const uint32_t inside = in_hole(a) ? a : b, outside = in_hole(a) ? b : a;
        (kept[outside] ? closed_edges : open_edges)[piece[inside]] += 1;
    });
    for (const auto& [a, b] : border_edges(mesh))
        for (const uint32_t v : {a, b})
            if (in_hole(v)) open_edges[piece[v]] += 1;
    for (uint32_t v = 0; v < count; ++v)
        if (in_hole(v) && away[v] < 0) open_edges[piece[v]] = INFINITY;
    constexpr double most_open = 0.1;
    Marks filled = kept;
    for (uint32_t v = 0; v < count; ++v)
        if (in_hole(v)) filled[v] = open_edges[piece[v]] <= most_open * closed_edges[piece[v]];
    return filled;
}

/// The triangles of which all vertices are kept.
Mesh part_of_vertices(const Mesh& mesh, const Marks& kept) {
    std::vector<uint8_t> keep;
    for (const auto& t : mesh.triangles) keep.push_back(kept[t[0]] && kept[t[1]] && kept[t[2]]);
    return part_of_triangles(mesh, keep);
}

size_t count_of(const Marks& marks) { return size_t(std::count(marks.begin(), marks.end(), 1)); }

}  // namespace

Mesh cut_mesh(const Mesh& mesh, std::span<const PlaneMap> maps, std::span<const std::vector<uint8_t>> masks,
              const SearchBall& region, const CutOptions& options, CutReport& report) {
    const size_t count = mesh.vertex_count();
    VertexEvidence evidence = evidence_of(mesh, maps, masks, options.depth);
    if (evidence.inside_out()) throw UserError(inside_out_text);
    Marks solid(count, 1);
    for (size_t v = 0; v < count; ++v) solid[v] = options.support == 0 || !evidence.in_free_space(v);
    if (count_of(solid) < count) {
        // A flap hides what is behind it, so that its support is seen without the flap.
        Mesh without_flaps{mesh.positions, {}};
        for (const auto& t : mesh.triangles)
            if (solid[t[0]] && solid[t[1]] && solid[t[2]]) without_flaps.triangles.push_back(t);
        evidence = evidence_of(without_flaps, maps, masks, options.depth);
    }
    report = {};
    report.vertices = count;
    Marks allowed(count, 0), kept(count, 0);
    for (size_t v = 0; v < count; ++v) {
        if ((mesh.positions[v].cast<double>() - region.centre).norm() > region.radius)
            ++report.off_region;
        else if (double(evidence.masked_out[v]) > options.outside * double(evidence.framed[v]))
            ++report.off_masks;
        else if (!solid[v])
            ++report.in_free_space;
        else
            allowed[v] = 1;
        kept[v] = allowed[v] && evidence.supported[v] >= uint32_t(options.support);
    }
    constexpr int notches = 2;  // rings; deeper ones at an edge are as likely flaps
    kept = without_holes(mesh, closed(mesh, kept, allowed, std::min(notches, options.close)), allowed, options.close);
    report.unsupported = count_of(allowed) - count_of(kept);
    Mesh part = part_of_vertices(mesh, kept);
    const auto keep_pieces = [&](const Mesh& of, double least_share) {
        Mesh large = large_pieces(of, least_share);
        report.apart += of.vertex_count() - large.vertex_count();
        return large;
    };
    std::vector<Camera> cameras;
    for (const PlaneMap& map : maps) cameras.push_back(map.camera);
    const auto ground = options.ground == GroundRule::keep ? std::nullopt : find_ground(part, cameras, region);
    if (ground) {
        report.ground = true;
        constexpr double least_object = 0.02;  // of the largest one's area: several may stand there
        const Mesh object = keep_pieces(above_ground(part, *ground, region), least_object);
        part =
            options.ground == GroundRule::cut ? object : large_pieces(within_disc(part, *ground, object), least_object);
    } else {
        part = keep_pieces(part, 1);
    }
    part = with_smooth_border(part);
    if (part.triangles.empty())
        throw UserError(fmt::format(
            "nothing of the mesh is left: of {} vertices {} are far away, {} outside the masks, {} in front of "
            "what photographs see, and {} are supported by fewer than {} of {} depth maps; give the mesh "
            "yourself, or more photographs that overlap",
            report.vertices, report.off_region, report.off_masks, report.in_free_space, report.unsupported,
            options.support, maps.size()));
    return part;
}

}  // namespace radiafit::tools
