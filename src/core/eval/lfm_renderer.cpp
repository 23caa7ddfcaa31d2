#include "eval/lfm_renderer.h"

#include <algorithm>
#include <stdexcept>

#include "base/parallel.h"
#include "model/lfm_text.h"

namespace radiafit {
namespace {

using Lane = Eigen::Array4f;  // r, g, b and padding
using Text = LfmText<float, Lane>;

Lane load(const float* from) { return Eigen::Map<const Lane>(from); }

}  // namespace

LfmRenderer::LfmRenderer(const Mesh& mesh, const LightFieldFit& fit)
    : mesh_(&mesh),
      fit_(&fit),
      atlas_(surface_atlas(mesh, fit.options)),
      lookup_(atlas_, fit.surface),
      rings_(mesh),
      layout_(rings_, atlas_, fit.options.view_side, fit.options.terms),
      frames_(vertex_frames(mesh)),
      scratch_(size_t(thread_count())) {
    if (fit.parameters.size() != layout_.size() || fit.samples.size() != 3 * mesh.vertex_count() ||
        fit.status.size() != 3 * mesh.vertex_count())
        throw std::invalid_argument("LfmRenderer: the fit belongs to another mesh");
}

const float* LfmRenderer::view_values(Scratch& scratch, uint32_t vertex, const Vec3d& eye) const {
    const size_t stride = layout_.stride();
    float* values = scratch.view.data() + vertex * stride;
    if (scratch.drawn[vertex] == scratch.picture) return values;
    scratch.drawn[vertex] = scratch.picture;
    const ViewFootprint f =
        view_footprint(frames_[vertex], mesh_->positions[vertex], eye, layout_.view_side(), fit_->options.lookup);
    const size_t side = size_t(layout_.view_side());
    const float* map = fit_->parameters.data() + layout_.view_offset(vertex) + f.texel * stride;
    for (size_t k = 0; k < stride; ++k)
        values[k] = f.weight[0] * map[k] + f.weight[1] * map[stride + k] + f.weight[2] * map[side * stride + k] +
                    f.weight[3] * map[(side + 1) * stride + k];
    for (size_t c = 0; c < 3; ++c) {
        const size_t problem = 3 * size_t(vertex) + c;
        if (fit_->samples[problem] > 0 && fit_->status[problem] != Status::no_samples) continue;
        for (size_t k = c; k < stride; k += 4) values[k] = 0;
    }
    return values;
}

void LfmRenderer::shade(const Camera& camera, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb,
                        int worker) {
    Scratch& scratch = scratch_.at(size_t(worker));
    scratch.view.resize(mesh_->vertex_count() * layout_.stride());
    scratch.drawn.resize(mesh_->vertex_count(), 0);
    if (++scratch.picture == 0) {  // wrapped: no mark may pass for this picture's
        std::fill(scratch.drawn.begin(), scratch.drawn.end(), 0);
        scratch.picture = 1;
    }
    rgb.assign(3 * pixels.size(), 0.0f);
    const Vec3d eye = camera.center();
    const size_t stride = layout_.stride();
    scratch.shown.begin(pixels.size());
    const auto colour_of = [&](uint32_t triangle, uint32_t local) {
        Lane sum = Lane::Zero();
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const float* surface = fit_->parameters.data() + layout_.map_offset(triangle, corner) + local * stride;
            const float* view = view_values(scratch, mesh_->triangles[triangle][corner], eye);
            for (size_t k = 0; k < stride; k += 4) sum = sum + Text::lfm_value(load(surface + k), load(view + k));
        }
        return sum;
    };
    for (size_t i = 0; i < pixels.size(); ++i) {
        const RasterPixel& pixel = pixels[i];
        if (pixel.triangle == no_triangle) continue;
        const TexelMix mix = lookup_.at(pixel.triangle, pixel.b1, pixel.b2);
        Lane colour = Lane::Zero();
        for (const auto& [triangle, local, weight] : mix.entries()) {
            const uint32_t texel = triangle * atlas_.texels_per_tile() + local;
            colour = colour + weight * scratch.shown.of(texel, [&] { return colour_of(triangle, local); });
        }
        for (int c = 0; c < 3; ++c) rgb[3 * i + size_t(c)] = colour[c];
    }
}

}  // namespace radiafit
