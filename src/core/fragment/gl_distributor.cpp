#include "fragment/gl_distributor.h"

#include <algorithm>

namespace radiafit {
namespace {
Defines with_projection(Defines defines) {
    defines.push_back({"PROJECTED", ""});
    return defines;
}
}  // namespace

GlDistributor::GlDistributor(const TriangleAtlas& atlas)
    : mesh_(atlas),
      program_(Program::draw("distribute/tile.vert", "distribute/pixel_index.frag", with_projection(mesh_.defines()))),
      taken_(GL_R32UI, atlas.width(), atlas.height()),
      framebuffer_({{&taken_}}) {
    mesh_.set_layout(program_);
}

void GlDistributor::distribute(const Camera& camera, const TargetImage& image, Distribution& out) {
    if (!items_ || items_->items().width() < image.width || items_->items().height() < image.height ||
        bits_ != image.bits) {
        const int width = std::max(image.width, items_ ? items_->items().width() : 0);
        const int height = std::max(image.height, items_ ? items_->items().height() : 0);
        items_.emplace(mesh_, width, height);
        slot_.emplace(width, height, image.bits);
        bits_ = image.bits;
    }
    slot_->upload(image);
    mesh_.select({{&camera}});
    items_->draw(camera);

    SlsMesh::set_camera(program_, camera);
    framebuffer_.bind();
    const GLuint none[4] = {no_pixel, no_pixel, no_pixel, no_pixel};
    gl().ClearNamedFramebufferuiv(framebuffer_.name(), GL_COLOR, 0, none);
    program_.bind("items", items_->items());
    program_.bind("image", slot_->texture());
    program_.use();
    mesh_.draw();

    const TriangleAtlas& atlas = mesh_.atlas();
    places_.resize(size_t(atlas.width()) * atlas.height());
    taken_.download(GL_RED_INTEGER, GL_UNSIGNED_INT, places_.data(), places_.size() * sizeof(uint32_t));
    const Texture& items = items_->items();
    item_pixels_.resize(size_t(items.width()) * items.height());
    items.download(GL_RED_INTEGER, GL_UNSIGNED_INT, item_pixels_.data(), item_pixels_.size() * sizeof(uint32_t));

    out.texel_pixel.resize(atlas.texel_count());
    out.covered_pixels = out.kept_pixels = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            out.covered_pixels +=
                item_pixels_[size_t(y) * items.width() + x] != no_texel && image.masked_in(size_t(y) * image.width + x);
    for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
        const auto [x, y] = atlas.place(texel);
        const uint32_t pixel = places_[size_t(y) * atlas.width() + x];
        out.texel_pixel[texel] = pixel;
        out.kept_pixels += pixel != no_pixel;
    }
}

}  // namespace radiafit
