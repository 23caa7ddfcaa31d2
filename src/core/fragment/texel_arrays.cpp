#include "fragment/texel_arrays.h"

#include "fragment/stored_layer.h"

namespace radiafit {

TexelShape::TexelShape(const Atlas& texels, const TexelModel& of, const Loss& its_loss)
    : atlas(&texels), model(&of), loss(its_loss) {
    place.reserve(texels.texel_count());
    for (uint32_t texel = 0; texel < texels.texel_count(); ++texel) {
        const auto [x, y] = texels.place(texel);
        place.push_back(uint32_t(y) * uint32_t(texels.width()) + uint32_t(x));
    }
}

TexelVector::TexelVector(const TexelShape& shape, Storage storage)
    : shape_(&shape), maps_(storage_format(storage), shape.width(), shape.height(), shape.maps()), storage_(storage) {}

void TexelVector::upload(std::span<const float> values) {
    const TexelShape& shape = *shape_;
    const size_t count = size_t(shape.model->parameters);
    for (int map = 0; map < shape.maps(); ++map) {
        StoredLayer data(maps_, storage_);
        const size_t first = 3 * size_t(map), numbers = std::min<size_t>(3, count - first);
        for (size_t texel = 0; texel < shape.texels(); ++texel) {
            float rgb[4] = {};
            std::copy_n(values.data() + texel * count + first, numbers, rgb);
            data.put(int(shape.place[texel]) % shape.width(), int(shape.place[texel]) / shape.width(), rgb);
        }
        maps_.upload(data.format(), data.type(), data.data().data(), map);
    }
}

void TexelVector::download(std::span<float> values) const {
    const TexelShape& shape = *shape_;
    const size_t count = size_t(shape.model->parameters);
    for (int map = 0; map < shape.maps(); ++map) {
        StoredLayer data(maps_, storage_);
        maps_.download(data.format(), data.type(), data.data().data(), data.data().size(), map);
        const size_t first = 3 * size_t(map), numbers = std::min<size_t>(3, count - first);
        for (size_t texel = 0; texel < shape.texels(); ++texel) {
            float rgb[4];
            data.get(int(shape.place[texel]) % shape.width(), int(shape.place[texel]) / shape.width(), rgb);
            std::copy_n(rgb, numbers, values.data() + texel * count + first);
        }
    }
}

std::vector<float> read_texels(const TexelShape& shape, const Texture& texture, int channel, int layer) {
    const bool single = texture.format() == GL_R32F;
    const size_t channels = single ? 1 : 4;
    std::vector<float> all(size_t(shape.width()) * size_t(shape.height()) * channels), out(shape.texels());
    texture.download(single ? GL_RED : GL_RGBA, GL_FLOAT, all.data(), all.size() * sizeof(float), layer);
    for (size_t texel = 0; texel < out.size(); ++texel)
        out[texel] = all[channels * shape.place[texel] + size_t(channel)];
    return out;
}

void write_surface(const TexelShape& shape, std::span<const float> darkness, Texture& surface) {
    const Atlas& atlas = *shape.atlas;
    std::vector<float> layers[2];
    for (auto& layer : layers) layer.resize(4 * size_t(shape.width()) * size_t(shape.height()));
    for (uint32_t texel = 0; texel < shape.texels(); ++texel) {
        const auto write = [&](int layer, const Vec3f& three, float fourth) {
            float* at = layers[layer].data() + 4 * size_t(shape.place[texel]);
            at[0] = three.x(), at[1] = three.y(), at[2] = three.z(), at[3] = fourth;
        };
        write(0, atlas.position(texel), atlas.usable(texel) ? 1.0f : 0.0f);
        write(1, atlas.normal(texel), darkness.empty() ? 0.0f : darkness[texel]);
    }
    for (int layer = 0; layer < 2; ++layer) surface.upload(GL_RGBA, GL_FLOAT, layers[layer].data(), layer);
}

MapBounds::MapBounds(const TexelShape& shape) {
    constexpr float unbound = 3e38f;
    lowest.assign(4 * size_t(shape.maps()), -unbound);
    highest.assign(lowest.size(), unbound);
    for (int i = 0; i < shape.model->parameters; ++i) {
        const auto [map, channel] = TexelShape::map_of(i);
        const size_t at = 4 * size_t(map) + size_t(channel);
        lowest[at] = float(shape.model->bounds[size_t(i)][0]);
        highest[at] = float(shape.model->bounds[size_t(i)][1]);
    }
}

void write_texels(const TexelShape& shape, std::span<const float> values, Texture& texture) {
    std::vector<float> all(size_t(shape.width()) * size_t(shape.height()));
    for (size_t texel = 0; texel < values.size(); ++texel) all[shape.place[texel]] = values[texel];
    texture.upload(GL_RED, GL_FLOAT, all.data());
}

}  // namespace radiafit
