#include "gl/problem_textures.h"

namespace radiafit {

ProblemTextures::ProblemTextures(const MapShape& shape)
    : state(GL_RGBA32F, shape.grid.columns, shape.grid.rows, 8),
      alpha(GL_RGBA32F, shape.grid.columns, shape.grid.rows),
      constants(GL_RGBA32F, shape.grid.columns, shape.grid.rows, 2),
      largest(GL_RGBA32F, shape.grid.columns, shape.grid.rows),
      ring(GL_RGBA32F, shape.grid.columns, shape.grid.rows),
      vertices_(shape.layout->problem_count()),
      columns_(shape.grid.columns),
      rows_(shape.grid.rows),
      sums_(GL_RGBA32F, columns_, rows_, int(Sum::count)) {
    std::vector<Target> fields;
    for (int field = 0; field < 8; ++field) fields.push_back({&state, field});
    state_target = Framebuffer(fields);
    line_target = Framebuffer({{&state, 6}, {&alpha}});
    largest_target = Framebuffer({{&largest}});
    ring_target = Framebuffer({{&ring}});
    for (int sum = 0; sum < int(Sum::count); ++sum) sum_targets_.push_back(Framebuffer({{&sums_, sum}}));
}

std::vector<float> ProblemTextures::read(const Texture& texture, int layer) const {
    std::vector<float> values(size_t(columns_) * rows_ * 4);
    texture.download(GL_RGBA, GL_FLOAT, values.data(), values.size() * sizeof(float), layer);
    values.resize(4 * vertices_);
    return values;
}

void ProblemTextures::write(Texture& texture, int layer, const std::vector<float>& values) {
    std::vector<float> padded(values);
    padded.resize(size_t(columns_) * rows_ * 4);
    texture.upload(GL_RGBA, GL_FLOAT, padded.data(), layer);
}

}  // namespace radiafit
