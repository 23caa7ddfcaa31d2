#include "reference/lfm_vertex.h"

#include "base/parallel.h"
#include "model/lfm_start.h"
#include "model/lfm_text.h"

namespace radiafit::fits {
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
      layout_(rings, atlas, options.view_side, options.terms),
      view_neighbours_(MapNeighbours::square(options.view_side)),
      frames_(vertex_frames(atlas.mesh())) {
    check_options(options);
    count();
}

Lanes<double> LfmVertices::target(const Corner& corner, const Sample& sample) const {
    const double lambda = double(atlas_->tile(corner.triangle).barycentric(sample.local)[corner.corner]);
    return broadcast3(lambda * double(samples_->scale)) * colour(sample);
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
            for (uint64_t s = first; s < last; ++s) sum += target(c, samples_->samples[s]);
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
    const std::span<const uint8_t> sides = layout_.sides(v);
    out.sides.assign(sides.begin(), sides.end());
    out.first_texels.assign(1, 0);
    for (const int side : sides) out.first_texels.push_back(out.first_texels.back() + TriangleTile::texels_of(side));
    out.options = options_;
    out.view = &view_neighbours_;
    for (size_t map = 0; map < ring.size(); ++map) {
        const uint32_t triangle = ring[map].triangle;
        for (uint32_t g = samples_->tile_groups[triangle]; g < samples_->tile_groups[triangle + 1]; ++g) {
            const View& view = dataset_->views[samples_->views[samples_->groups[g].image]];
            const ViewFootprint f = view_footprint(frames_[v], atlas_->mesh().positions[v], view.camera.center(),
                                                   options_.view_side, options_.lookup);
            LfmVertex::Group group{uint32_t(map), f.texel, {}, uint32_t(out.local.size())};
            for (int j = 0; j < 4; ++j) group.weight[j] = double(f.weight[j]);
            out.groups.push_back(group);
            for (const Sample& s : samples_->of_group(g)) {
                out.local.push_back(s.local);
                out.target.push_back(target(ring[map], s));
            }
        }
    }
    out.groups.push_back({uint32_t(ring.size()), 0, {}, uint32_t(out.local.size())});
    const size_t texels = out.surface_texels();
    out.inverse_density = inverse_density(options_, texels, statistics_.samples[v]);
    out.lambda_surface = double(options_.lambda_surface);
    for (int c = 0; c < 3; ++c)
        out.lambda_view[c] = double(scaled_lambda_view(options_, texels, statistics_.mean[3 * v + size_t(c)]));
}

Lanes<double> lfm_error(const LfmVertex& vertex, const Lanes<double>* p) {
    using Text = LfmText<double, V>;
    const size_t terms = vertex.terms();
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
                r += Text::lfm_value(p[vertex.map_begin(g.map) + vertex.local[s] * terms + k], h[k]);
            sum += r * r;
        }
    }
    return 0.5 * vertex.inverse_density * sum + lfm_penalties(vertex, p);
}

Lanes<double> lfm_penalties(const LfmVertex& vertex, const Lanes<double>* p) {
    const int terms = vertex.options.terms;
    V error{};
    std::vector<V> unused(vertex.size()), scratch(2 * std::max(vertex.largest_tile(), vertex.view->texel_count()));
    for (size_t map = 0; map < vertex.maps(); ++map)
        add_smoothness<double>(vertex.tile(map), terms, broadcast3(vertex.lambda_surface), p + vertex.map_begin(map),
                               &unused[vertex.map_begin(map)], error, scratch.data());
    add_smoothness<double>(*vertex.view, terms, vertex.lambda_view, p + vertex.view_begin(),
                           &unused[vertex.view_begin()], error, scratch.data());
    add_bounds<double>(vertex.options, vertex.size() / vertex.terms(), p, unused.data(), error);
    return error;
}

}  // namespace radiafit::fits
