#include "publish/coded_map.h"

#include <algorithm>
#include <cmath>

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

constexpr int band = 32;  // rows
constexpr auto every = int(1 / share_of_bands);
bool is_large(const ByteRaster& image) { return image.height >= 4 * band * every; }

/// All of a small image; of a large one bands of rows.
ByteRaster bands_of(const ByteRaster& image) {
    if (!is_large(image)) return image;
    ByteRaster out{image.width, 0, image.channels, {}};
    const auto row = ptrdiff_t(image.width) * image.channels;
    for (int y = 0; y + band <= image.height; y += band * every, out.height += band)
        out.bytes.insert(out.bytes.end(), image.bytes.begin() + y * row, image.bytes.begin() + (y + band) * row);
    return out;
}

}  // namespace

float stored_number(const PageMap& map, float value) {
    if (!std::isfinite(value)) return 0;
    return map.root ? std::copysign(std::sqrt(std::abs(value)), value) : value;
}

float number_of(const PageMap& map, float stored) { return map.root ? stored * std::abs(stored) : stored; }

SteppedMap stepped_map(const PageMap& map, const std::array<float, 3>& step) {
    const size_t channels = map.image.channels.size(), pixels = map.image.values.size() / channels;
    SteppedMap out;
    out.low = {map.image.width, map.image.height, 3, std::vector<uint8_t>(3 * pixels)};
    out.high = out.low;
    int most = 0;
    for (size_t c = 0; c < channels; ++c) {
        const Steps steps = steps_of(map, c, step[c]);
        out.scale[c] = steps.scale;
        out.offset[c] = -(steps.scale * float(steps.bias));
        most = std::max(most, steps.most);
        for (size_t i = 0; i < pixels; ++i) {
            const float stored = stored_number(map, map.image.values[i * channels + c]);
            const int q = std::clamp(int(std::lround(stored / steps.scale)) + steps.bias, 0, levels - 1);
            out.low.bytes[3 * i + c] = uint8_t(q % low_levels);
            out.high.bytes[3 * i + c] = uint8_t(q / low_levels);
        }
    }
    if (most < low_levels) out.high = {};
    return out;
}

PageMap decoded_map(const SteppedMap& stepped, const PageMap& like) {
    PageMap out = like;
    const std::vector<uint8_t>&low = stepped.low.bytes, &high = stepped.high.bytes;
    const size_t channels = like.image.channels.size();
    for (size_t i = 0; i < like.image.values.size() / channels; ++i)
        for (size_t c = 0; c < channels; ++c) {
            const int upper = high.empty() ? 0 : high[3 * i + c];
            const float q = float(low[3 * i + c] + low_levels * upper);
            out.image.values[i * channels + c] = number_of(like, stepped.scale[c] * q + stepped.offset[c]);
        }
    return out;
}

CodedMap code_map(const SteppedMap& stepped) {
    CodedMap out{stepped.scale, stepped.offset, lossless_webp(stepped.low), {}};
    if (!stepped.high.bytes.empty()) out.high = lossless_webp(stepped.high);
    return out;
}

SteppedMap stepped_map(const CodedMap& coded) {
    return {coded.scale, coded.offset, read_webp(coded.low), coded.high.empty() ? ByteRaster() : read_webp(coded.high)};
}

double share_coded(const SteppedMap& stepped) { return is_large(stepped.low) ? share_of_bands : 1; }

size_t expected_bytes(const SteppedMap& stepped) {
    double bytes = 0;
    for (const ByteRaster* image : {&stepped.low, &stepped.high}) {
        if (image->bytes.empty()) continue;
        const ByteRaster some = bands_of(*image);
        bytes += double(lossless_webp(some).size()) * double(image->bytes.size()) / double(some.bytes.size());
    }
    return size_t(bytes);
}

}  // namespace radiafit::tools
