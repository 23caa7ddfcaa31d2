#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "fragment/half_rounding.h"
#include "fragment/map_vector.h"
#include "fragment/pass_runner.h"
#include "geometry/atlas.h"
#include "model/texel_model.h"

/// Arrays with an entry per texel of an atlas, in its 2-D layout.
namespace radiafit {

/// Everything that fixes the shape of such arrays. Texels are counted as the atlas does.
struct TexelShape {
    const Atlas* atlas;
    const TexelModel* model;
    std::vector<uint32_t> place;  ///< [texels] row * width + column

    Loss loss;

    TexelShape(const Atlas& atlas, const TexelModel& model, const Loss& loss = {});
    size_t texels() const { return place.size(); }
    int width() const { return atlas->width(); }
    int height() const { return atlas->height(); }
    int shape_maps() const { return (model->shape + 2) / 3; }
    int maps() const { return model->basis + shape_maps(); }
    /// Layers for the numbers that the channels share on the diagonal of J'J, four each.
    int diagonal_layers() const { return (model->basis + model->shape + 3) / 4; }
    /// MODEL, HELD where it holds parameters, STORAGE, and of loss_defines()
    Defines defines(Storage storage) const {
        Defines out{{"MODEL", model->name}};
        if (model->any_held()) out.emplace_back("HELD", "");
        return out + storage_defines(storage) + loss_defines(loss);
    }
    /// The layer and channel of parameter i. See shaders/reflect/parameters.glsl.
    static std::array<int, 2> map_of(int parameter) { return {parameter / 3, parameter % 3}; }
};

/// Parameters, or as many numbers: RGBA maps, three numbers each. Parameters order is [texel][parameter].
class TexelVector {
public:
    TexelVector(const TexelShape& shape, Storage storage);  ///< shape must outlive it
    void upload(std::span<const float> values);
    void download(std::span<float> values) const;  ///< waits
    void clear() { maps_.clear(); }
    const Texture& maps() const { return maps_; }
    Target target(int map) const { return {&maps_, map}; }

private:
    const TexelShape* shape_;
    Texture maps_;
    Storage storage_;
};

/// Layers of RGBA that passes over images add to, each a target by itself, or all of one pass.
struct TexelSumLayers {
    Texture layers;
    std::vector<Framebuffer> each;  ///< [layer]
    Framebuffer all;

    TexelSumLayers() = default;
    TexelSumLayers(GLenum format, const TexelShape& shape, int count)
        : layers(format, shape.width(), shape.height(), count) {
        for (int layer = 0; layer < count; ++layer) each.push_back(Framebuffer({{&layers, layer}}));
        all = Framebuffer(targets());
    }
    std::vector<Target> targets() const {
        std::vector<Target> list;
        for (int layer = 0; layer < layers.layers(); ++layer) list.push_back({&layers, layer});
        return list;
    }
    void clear(PassRunner& run) const {
        for (const Framebuffer& target : each) run.clear(target);
    }
};

/// One number of each texel, from a layer of an array [places][channels]. Waits.
std::vector<float> read_texels(const TexelShape& shape, const Texture& texture, int channel, int layer = 0);
/// What shaders/reflect/site.glsl reads, into two layers of RGBA. darkness [texels], or none: samples whose channels'
/// sum is below that share of u_z lie in shadow.
void write_surface(const TexelShape& shape, std::span<const float> darkness, Texture& surface);
/// Bounds of parameters, for shaders/reflect/bounds.glsl: [map][4].
struct MapBounds {
    std::vector<float> lowest, highest;
    explicit MapBounds(const TexelShape& shape);
};
/// The inverse of read_texels(): [texels] into a texture of one channel.
void write_texels(const TexelShape& shape, std::span<const float> values, Texture& texture);

}  // namespace radiafit
