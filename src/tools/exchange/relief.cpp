#include "exchange/relief.h"

#include <algorithm>
#include <cmath>

#include "exchange/normal_integration.h"
#include "image/png_file.h"

namespace radiafit::tools {

Relief relief_of(const SurfaceNormals& normals, const Atlas& atlas, const Grid& grid) {
    std::vector<uint8_t> surface(atlas.texel_count());
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) surface[t] = atlas.usable(t);
    Relief out;
    out.step = {grid.right.norm(), grid.down.norm()};
    const HeightMap found = integrate_normals(grid.width, grid.height, normals.normals, surface, out.step);
    out.parts = found.parts;
    out.heights = {grid.width, grid.height, 2, {}};
    bool any = false;
    for (size_t i = 0; i < surface.size(); ++i) {
        out.heights.values.insert(out.heights.values.end(), {found.heights[i], surface[i] ? 1.0f : 0.0f});
        if (!surface[i]) continue;
        out.least = any ? std::min(out.least, found.heights[i]) : found.heights[i];
        out.most = any ? std::max(out.most, found.heights[i]) : found.heights[i];
        any = true;
    }
    return out;
}

std::string height_png(const Relief& relief) {
    const TextureImage& heights = relief.heights;
    const double range = std::max(double(relief.most) - double(relief.least), 1e-30);
    std::vector<uint16_t> values;
    values.reserve(heights.values.size() / 2);
    for (size_t i = 0; i < heights.values.size(); i += 2) {
        const double share = std::clamp((double(heights.values[i]) - double(relief.least)) / range, 0.0, 1.0);
        values.push_back(heights.values[i + 1] > 0 ? uint16_t(1 + std::lround(65534 * share)) : uint16_t(0));
    }
    return grey16_png_bytes(heights.width, heights.height, values, "radiafit");
}

}  // namespace radiafit::tools
