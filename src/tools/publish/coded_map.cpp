#include "publish/coded_map.h"

#include <algorithm>
#include <cmath>

#include "image/web/webp_image.h"

namespace radiafit::tools {
namespace {

constexpr int levels = 65536, low_levels = 256;

/// Whole numbers of a channel, around 0: with the middle ones in the lower byte's middle, few wrap into the upper.
struct Steps {
    float scale = 1;
    int bias = 0, most = 0;
};

Steps steps_of(const PageMap& map, size_t channel, float step) {
    const size_t channels = map.image.channels.size();
    float lowest = 0, highest = 0;
    for (size_t i = channel; i < map.image.values.size(); i += channels) {
        const float stored = stored_number(map, map.image.values[i]);
        lowest = std::min(lowest, stored);
        highest = std::max(highest, stored);
    }
    Steps out;
    out.scale = std::max(step, (highest - lowest) / float(levels - 2 * low_levels));
    const int below = int(std::lround(-lowest / out.scale)), above = int(std::lround(highest / out.scale));
    out.bias = below;
    if (below + above >= low_levels) {
        // the middle of what is common, zero, at the middle of a byte
        out.bias = low_levels / 2;
        while (out.bias < below) out.bias += low_levels;
    }
    out.most = out.bias + above;
    return out;
}

}  // namespace

float stored_number(const PageMap& map, float value) {
    if (!std::isfinite(value)) return 0;
    return map.root ? std::copysign(std::sqrt(std::abs(value)), value) : value;
}

float number_of(const PageMap& map, float stored) { return map.root ? stored * std::abs(stored) : stored; }

CodedMap code_map(const PageMap& map, const std::array<float, 3>& step) {
    const size_t channels = map.image.channels.size(), pixels = map.image.values.size() / channels;
    CodedMap out;
    ByteRaster low{map.image.width, map.image.height, 3, std::vector<uint8_t>(3 * pixels)};
    ByteRaster high = low;
    int most = 0;
    for (size_t c = 0; c < channels; ++c) {
        const Steps steps = steps_of(map, c, step[c]);
        out.scale[c] = steps.scale;
        out.offset[c] = -(steps.scale * float(steps.bias));
        most = std::max(most, steps.most);
        for (size_t i = 0; i < pixels; ++i) {
            const float stored = stored_number(map, map.image.values[i * channels + c]);
            const int q = std::clamp(int(std::lround(stored / steps.scale)) + steps.bias, 0, levels - 1);
            low.bytes[3 * i + c] = uint8_t(q % low_levels);
            high.bytes[3 * i + c] = uint8_t(q / low_levels);
        }
    }
    out.low = lossless_webp(low);
    if (most >= low_levels) out.high = lossless_webp(high);
    return out;
}

PageMap decoded_map(const CodedMap& coded, const PageMap& like) {
    PageMap out = like;
    const ByteRaster low = read_webp(coded.low);
    const ByteRaster high = coded.high.empty() ? ByteRaster{} : read_webp(coded.high);
    const size_t channels = like.image.channels.size();
    for (size_t i = 0; i < like.image.values.size() / channels; ++i)
        for (size_t c = 0; c < channels; ++c) {
            const int upper = high.bytes.empty() ? 0 : high.bytes[3 * i + c];
            const float q = float(low.bytes[3 * i + c] + low_levels * upper);
            out.image.values[i * channels + c] = number_of(like, coded.scale[c] * q + coded.offset[c]);
        }
    return out;
}

}  // namespace radiafit::tools
