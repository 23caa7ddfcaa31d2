#include "reference/lfm_vertex.h"

#include "base/parallel.h"
#include "model/lfm_start.h"
#include "model/lfm_text.h"

namespace radiafit {
namespace {

using V = Lanes<double>;

V colour(const Sample& s) { return V{double(s.rgb[0]), double(s.rgb[1]), double(s.rgb[2]), 0}; }

}  // namespace

LfmVertices::LfmVertices(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                         const SampleList& samples, const LfmOptions& options)
    : dataset_(&dataset),
      atlas_(&atlas),
      rings_(&rings),
      samples_(&samples),
      options_(options),
      layout_(rings, int(atlas.texels_per_tile()), options.view_side, options.terms),
      tile_neighbours_(MapNeighbours::triangle(options.surface_side)),
      view_neighbours_(MapNeighbours::square(options.view_side)),
      frames_(vertex_frames(atlas.mesh())) {
    check_options(options);
    for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local)
        for (int corner = 0; corner < 3; ++corner)
            target_weight_[corner].push_back(
                broadcast3(double(atlas.barycentric(local)[size_t(corner)]) * double(samples.scale)));
    count();
}

void LfmVertices::count() {
    const size_t vertices = rings_->vertex_count();
    statistics_.samples.assign(vertices, 0);
    statistics_.mean.assign(3 * vertices, 0.0f);
    parallel_for(vertices, 64, [&](size_t v, int) {
        V sum{};
        uint32_t count = 0;
        for (const Corner& c : rings_->ring(v)) {
            const uint64_t first = samples_->groups[samples_->tile_groups[c.triangle]].first;
            const uint64_t last = samples_->groups[samples_->tile_groups[c.triangle + 1]].first;
            for (uint64_t s = first; s < last; ++s)
                sum += target_weight_[c.corner][samples_->samples[s].local] * colour(samples_->samples[s]);
            count += uint32_t(last - first);
        }
        statistics_.samples[v] = count;
        for (int c = 0; c < 3 && count; ++c) statistics_.mean[3 * v + size_t(c)] = float(sum[c] / count);
    });
}

void LfmVertices::gather(size_t v, LfmVertex& out) const {
    const auto ring = rings_->ring(v);
    out.groups.clear();
    out.local.clear();
    out.target.clear();
    out.maps = ring.size();
    out.options = options_;
    out.tile = &tile_neighbours_;
    out.view = &view_neighbours_;
    for (size_t map = 0; map < ring.size(); ++map) {
        const auto& [triangle, corner] = ring[map];
        for (uint32_t g = samples_->tile_groups[triangle]; g < samples_->tile_groups[triangle + 1]; ++g) {
            const View& view = dataset_->views[samples_->views[samples_->groups[g].image]];
            const ViewFootprint f = view_footprint(frames_[v], atlas_->mesh().positions[v], view.camera.center(),
                                                   options_.view_side, options_.lookup);
            LfmVertex::Group group{uint32_t(map), f.texel, {}, uint32_t(out.local.size())};
            for (int j = 0; j < 4; ++j) group.weight[j] = double(f.weight[j]);
            out.groups.push_back(group);
            for (const Sample& s : samples_->of_group(g)) {
                out.local.push_back(s.local);
                out.target.push_back(target_weight_[corner][s.local] * colour(s));
            }
        }
    }
    out.groups.push_back({uint32_t(ring.size()), 0, {}, uint32_t(out.local.size())});
    const size_t texels = ring.size() * atlas_->texels_per_tile();
    out.inverse_density = inverse_density(options_, texels, statistics_.samples[v]);
    out.lambda_surface = double(options_.lambda_surface);
    for (int c = 0; c < 3; ++c)
        out.lambda_view[c] = double(scaled_lambda_view(options_, texels, statistics_.mean[3 * v + size_t(c)]));
}

Lanes<double> lfm_error(const LfmVertex& vertex, const Lanes<double>* p) {
    using Text = LfmText<double, V>;
    const size_t terms = vertex.terms(), tile = vertex.tile->texel_count();
    V sum{};
    std::vector<V> h(terms);
    for (size_t i = 0; i + 1 < vertex.groups.size(); ++i) {
        const LfmVertex::Group& g = vertex.groups[i];
        for (size_t k = 0; k < terms; ++k) {
            h[k] = V{};
            for (int j = 0; j < 4; ++j) h[k] += g.weight[j] * p[vertex.view_begin() + vertex.corner(g, j) * terms + k];
        }
        for (uint32_t s = g.first; s < vertex.groups[i + 1].first; ++s) {
            V r = -vertex.target[s];
            for (size_t k = 0; k < terms; ++k)
                r += Text::lfm_value(p[(g.map * tile + vertex.local[s]) * terms + k], h[k]);
            sum += r * r;
        }
    }
    return 0.5 * vertex.inverse_density * sum + lfm_penalties(vertex, p);
}

Lanes<double> lfm_penalties(const LfmVertex& vertex, const Lanes<double>* p) {
    const size_t tile = vertex.tile->texel_count(), width = tile * vertex.terms();
    const int terms = vertex.options.terms;
    V error{};
    std::vector<V> unused(vertex.size()), scratch(2 * std::max(tile, vertex.view->texel_count()));
    for (size_t at = 0; at < vertex.view_begin(); at += width)
        add_smoothness<double>(*vertex.tile, terms, broadcast3(vertex.lambda_surface), p + at, &unused[at], error,
                               scratch.data());
    add_smoothness<double>(*vertex.view, terms, vertex.lambda_view, p + vertex.view_begin(),
                           &unused[vertex.view_begin()], error, scratch.data());
    add_bounds<double>(vertex.options, vertex.size() / vertex.terms(), p, unused.data(), error);
    return error;
}

}  // namespace radiafit
