#include "capture/image_scale.h"

#include <algorithm>
#include <cmath>

#include "dataset/dataset.h"

namespace radiafit::tools {
namespace {

/// Which old pixels one new pixel covers along one axis, and by how much.
struct Overlap {
    int first;
    std::vector<float> weights;  ///< sum 1
};

std::vector<Overlap> cover(int old_size, int size) {
    std::vector<Overlap> result(static_cast<size_t>(size));
    const double step = double(old_size) / size;
    for (int i = 0; i < size; ++i) {
        const double begin = i * step, end = (i + 1) * step;
        Overlap& c = result[size_t(i)];
        c.first = static_cast<int>(begin);
        const int last = std::min(static_cast<int>(std::ceil(end - 1e-9)), old_size);
        for (int p = c.first; p < last; ++p)
            c.weights.push_back(static_cast<float>((std::min<double>(p + 1, end) - std::max<double>(p, begin)) / step));
    }
    return result;
}

/// value(i) of channel i of the interleaved old image; store(i, mean) for the new one.
template <class Value, class Store>
void average(int old_width, int old_height, int width, int height, size_t channels, const Value& value,
             const Store& store) {
    const std::vector<Overlap> columns = cover(old_width, width), rows = cover(old_height, height);
    const size_t old_row = size_t(old_width) * channels;
    std::vector<float> sums(old_row);
    for (size_t y = 0; y < size_t(height); ++y) {
        std::fill(sums.begin(), sums.end(), 0.0f);
        for (size_t k = 0; k < rows[y].weights.size(); ++k) {
            const size_t source = (size_t(rows[y].first) + k) * old_row;
            for (size_t i = 0; i < old_row; ++i) sums[i] += rows[y].weights[k] * value(source + i);
        }
        for (size_t x = 0; x < size_t(width); ++x)
            for (size_t c = 0; c < channels; ++c) {
                float mean = 0;
                for (size_t k = 0; k < columns[x].weights.size(); ++k)
                    mean += columns[x].weights[k] * sums[(size_t(columns[x].first) + k) * channels + c];
                store((y * size_t(width) + x) * channels + c, mean);
            }
    }
}

std::vector<float> make_linear_table(int bits, bool linear) {
    std::vector<float> table(size_t(1) << bits);
    for (size_t i = 0; i < table.size(); ++i) {
        const double stored = double(i) / double(table.size() - 1);
        table[i] = static_cast<float>(linear ? stored : srgb_decode(stored));
    }
    return table;
}

}  // namespace

const std::vector<float>& linear_table(int bits, bool linear) {
    static const std::vector<float> srgb8 = make_linear_table(8, false), linear8 = make_linear_table(8, true);
    static const std::vector<float> srgb16 = make_linear_table(16, false), linear16 = make_linear_table(16, true);
    if (bits == 8) return linear ? linear8 : srgb8;
    return linear ? linear16 : srgb16;
}

LightCoder::LightCoder(int bits, bool linear) : first_(size_t(cells) + 1), least_(size_t(1) << bits) {
    const double largest = double(least_.size() - 1);
    for (size_t i = 1; i < least_.size(); ++i) {
        const double border = (double(i) - 0.5) / largest;
        least_[i] = static_cast<float>(linear ? border : srgb_decode(border));
    }
    size_t value = 0;
    for (size_t cell = 0; cell < first_.size(); ++cell) {
        while (value + 1 < least_.size() && float(cell) / float(cells) >= least_[value + 1]) ++value;
        first_[cell] = static_cast<uint16_t>(value);
    }
}

const LightCoder& LightCoder::of(int bits, bool linear) {
    static const LightCoder srgb8(8, false), linear8(8, true), srgb16(16, false), linear16(16, true);
    if (bits == 8) return linear ? linear8 : srgb8;
    return linear ? linear16 : srgb16;
}

std::array<int, 2> size_within(int width, int height, int max_size) {
    const int longest = std::max(width, height);
    if (max_size == 0 || longest <= max_size) return {width, height};
    const double scale = double(max_size) / longest;
    return {std::max(1, static_cast<int>(std::lround(width * scale))),
            std::max(1, static_cast<int>(std::lround(height * scale)))};
}

ImageFile scale_down(const ImageFile& image, int width, int height) {
    ImageFile out{width, height, image.bits, image.linear, {}, {}, {}, {}};
    const std::vector<float>& light = linear_table(image.bits == 8 ? 8 : 16, image.linear);
    const double largest = double(light.size() - 1);
    const auto stored = [&](float mean) {
        return std::clamp(std::round(largest * (image.linear ? double(mean) : srgb_encode(mean))), 0.0, largest);
    };
    const size_t size = size_t(width) * size_t(height);
    if (image.bits == 8) {
        out.rgb8.resize(size * 3);
        average(
            image.width, image.height, width, height, 3, [&](size_t i) { return light[image.rgb8[i]]; },
            [&](size_t i, float mean) { out.rgb8[i] = static_cast<uint8_t>(stored(mean)); });
    } else if (image.bits == 32) {
        out.rgb32.resize(size * 3);
        average(
            image.width, image.height, width, height, 3, [&](size_t i) { return image.rgb32[i]; },
            [&](size_t i, float mean) { out.rgb32[i] = mean; });
    } else {
        out.rgb16.resize(size * 3);
        average(
            image.width, image.height, width, height, 3, [&](size_t i) { return light[image.rgb16[i]]; },
            [&](size_t i, float mean) { out.rgb16[i] = static_cast<uint16_t>(stored(mean)); });
    }
    if (!image.alpha.empty()) {
        out.alpha.resize(size);
        average(
            image.width, image.height, width, height, 1, [&](size_t i) { return float(image.alpha[i]); },
            [&](size_t i, float mean) { out.alpha[i] = static_cast<uint8_t>(std::lround(mean)); });
    }
    return out;
}

std::vector<uint8_t> scale_down_mask(const std::vector<uint8_t>& mask, int old_width, int old_height, int width,
                                     int height) {
    std::vector<uint8_t> out(size_t(width) * size_t(height));
    average(
        old_width, old_height, width, height, 1, [&](size_t i) { return mask[i] ? 1.0f : 0.0f; },
        [&](size_t i, float mean) { out[i] = mean >= 0.5f - 1e-5f ? 255 : 0; });
    return out;
}

}  // namespace radiafit::tools
