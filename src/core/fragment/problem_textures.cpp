#include "fragment/problem_textures.h"

#include "optim/verbs.h"

namespace radiafit {

ProblemTextures::ProblemTextures(const MapShape& shape, Sums sums)
    : constants(GL_RGBA32F, shape.grid.columns, shape.grid.rows, 2),
      largest(GL_RGBA32F, shape.grid.columns, shape.grid.rows),
      ring(GL_RGBA32F, shape.grid.columns, shape.grid.rows),
      vertices_(shape.layout->problem_count()),
      columns_(shape.grid.columns),
      rows_(shape.grid.rows),
      sample_sums_(sums_format(sums), columns_, rows_, int(Sum::penalty)),
      map_sums_(GL_RGBA32F, columns_, rows_, int(Sum::count) - int(Sum::penalty)) {
    largest_target = Framebuffer({{&largest}});
    ring_target = Framebuffer({{&ring}});
    for (int layer = 0; layer < sample_sums_.layers(); ++layer)
        sum_targets_.push_back(Framebuffer({{&sample_sums_, layer}}));
    for (int layer = 0; layer < map_sums_.layers(); ++layer) sum_targets_.push_back(Framebuffer({{&map_sums_, layer}}));
    make_products(Room().product_count());
}

void ProblemTextures::make_products(int count) {
    if (products_ && products_.layers() == count) return;
    product_targets_.clear();
    products_ = Texture(GL_RGBA32F, columns_, rows_, count);
    for (int layer = 0; layer < count; ++layer) product_targets_.push_back(Framebuffer({{&products_, layer}}));
}

std::vector<float> ProblemTextures::read(Sum sum) const {
    const int first = int(Sum::penalty);
    return sum < Sum::penalty ? read(sample_sums_, int(sum)) : read(map_sums_, int(sum) - first);
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
