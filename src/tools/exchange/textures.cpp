#include "exchange/textures.h"

#include <algorithm>
#include <cmath>

#include "exchange/surface_normals.h"
#include "image/png_file.h"

namespace radiafit::tools {
namespace {

uint8_t byte_of(double value) { return uint8_t(std::lround(255 * std::clamp(value, 0.0, 1.0))); }

std::vector<float> flat(const std::vector<Vec3f>& vectors) {
    std::vector<float> out;
    out.reserve(3 * vectors.size());
    for (const Vec3f& v : vectors) out.insert(out.end(), v.begin(), v.end());
    return out;
}

TextureImage with_alpha(const TextureImage& colours, const Atlas& atlas) {
    TextureImage out{colours.width, colours.height, 4, {}};
    for (size_t i = 0; i < colours.values.size(); i += 3)
        out.values.insert(out.values.end(), {colours.values[i], colours.values[i + 1], colours.values[i + 2], 0.0f});
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        const auto [x, y] = atlas.place(t);
        if (atlas.usable(t)) out.values[4 * (size_t(y) * size_t(out.width) + size_t(x)) + 3] = 1;
    }
    return out;
}

bool all_usable(const Atlas& atlas) {
    for (uint32_t t = 0; t < atlas.texel_count(); ++t)
        if (!atlas.usable(t)) return false;
    return true;
}

}  // namespace

LookTextures textures_of(const SurfaceLook& look, const Dataset& dataset) {
    LookTextures out;
    if (!dataset.has_grid()) out.tiles.emplace(dynamic_cast<const TriangleAtlas&>(*look.atlas));
    const auto texture = [&](const std::vector<float>& values, int channels) {
        return out.tiles ? out.tiles->bake(values, channels, look.lookup) : in_layout(*look.atlas, values, channels);
    };
    out.base_colour = texture(flat(look.base_colour), 3);
    if (!look.roughness.empty()) out.roughness = texture(look.roughness, 1);
    if (out.tiles) return out;
    if (!all_usable(*look.atlas)) out.base_colour = with_alpha(out.base_colour, *look.atlas);
    if (!dataset.grid.texel_normals.empty())
        out.normals = normals_texture(normals_of_dataset(*look.atlas, dataset).normals, look, out);
    return out;
}

TextureImage normals_texture(const std::vector<Vec3f>& normals, const SurfaceLook& look, const LookTextures& textures) {
    if (!textures.tiles) {
        TextureImage out{look.atlas->width(), look.atlas->height(), 3, flat(normals)};
        for (size_t i = 0; i < out.values.size(); i += 3)
            if (Vec3f::Map(&out.values[i]).isZero(0)) out.values[i + 2] = 1;
        return out;
    }
    TextureImage out = textures.tiles->bake(flat(normals), 3, look.lookup);
    for (size_t i = 0; i < out.values.size(); i += 3) Vec3f::Map(&out.values[i]).normalize();
    return out;
}

std::string base_colour_png(const LookTextures& textures) {
    const TextureImage& texture = textures.base_colour;
    std::vector<uint8_t> bytes;
    bytes.reserve(texture.values.size());
    for (size_t i = 0; i < texture.values.size(); ++i) {
        const double value = std::clamp(double(texture.values[i]), 0.0, 1.0);
        bytes.push_back(byte_of(i % size_t(texture.channels) == 3 ? value : srgb_encode(value)));
    }
    return png_bytes(texture.width, texture.height, bytes, "radiafit");
}

std::string roughness_png(const TextureImage& roughness) {
    std::vector<uint8_t> bytes;
    bytes.reserve(3 * roughness.values.size());
    for (const float value : roughness.values) bytes.insert(bytes.end(), {0, byte_of(double(value)), 0});
    return png_bytes(roughness.width, roughness.height, bytes, "radiafit");
}

std::string normals_png(const TextureImage& normals) {
    std::vector<uint8_t> bytes;
    bytes.reserve(normals.values.size());
    for (const float value : normals.values) bytes.push_back(byte_of(0.5 * double(value) + 0.5));
    return png_bytes(normals.width, normals.height, bytes, "radiafit");
}

}  // namespace radiafit::tools
