#pragma once
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/linear.h"
#include "base/rng.h"

/// Files of RTI by their formats' descriptions, from bytes that are known; and what these bytes mean, in double.
namespace radiafit::testing {

/// [count][pixels] random bytes from `least` to `most`.
inline std::vector<std::vector<uint8_t>> random_planes(size_t count, size_t pixels, uint64_t seed, int least = 0,
                                                       int most = 255) {
    Rng rng(seed);
    std::vector<std::vector<uint8_t>> planes(count, std::vector<uint8_t>(pixels));
    for (auto& plane : planes)
        for (uint8_t& byte : plane) byte = uint8_t(least + int(rng.uniform() * float(most - least + 1)));
    return planes;
}

/// Planes are of the picture as one sees it, row 0 on top: six coefficients of luminance and three colours, or six of
/// red, of green, of blue.
struct PtmBytes {
    int width = 0, height = 0;
    std::array<double, 6> scale{}, bias{};
    std::vector<std::vector<uint8_t>> planes;

    size_t pixels() const { return size_t(width) * size_t(height); }
    bool luminance() const { return planes.size() == 9; }
    /// C = a0 Lu^2 + a1 Lv^2 + a2 Lu Lv + a3 Lu + a4 Lv + a5, of 255.
    double value(size_t pixel, size_t channel, const Vec3d& l) const {
        const double functions[6] = {l.x() * l.x(), l.y() * l.y(), l.x() * l.y(), l.x(), l.y(), 1};
        double sum = 0;
        for (size_t k = 0; k < 6; ++k) {
            const double byte = planes[luminance() ? k : 6 * channel + k][pixel];
            sum += functions[k] * scale[k] * (byte - bias[k]);
        }
        return (luminance() ? sum * planes[6 + channel][pixel] / 255 : sum) / 255;
    }

    std::string head(const std::string& version, const std::string& format) const {
        std::string text = fmt::format("{}\n{}\n{}\n{}\n", version, format, width, height);
        for (size_t k = 0; k < 6; ++k) text += fmt::format("{}{}", scale[k], k < 5 ? " " : "\n");
        for (size_t k = 0; k < 6; ++k) text += fmt::format("{}{}", bias[k], k < 5 ? " " : "\n");
        return text;
    }
    /// Appends planes [first, end) interleaved, rows from the bottom.
    void put(std::string& bytes, size_t first, size_t end) const {
        for (int row = height - 1; row >= 0; --row)
            for (int column = 0; column < width; ++column)
                for (size_t k = first; k < end; ++k)
                    bytes.push_back(char(planes[k][size_t(row) * size_t(width) + size_t(column)]));
    }
    std::string uncompressed(const std::string& version = "PTM_1.2") const {
        std::string bytes = head(version, luminance() ? "PTM_FORMAT_LRGB" : "PTM_FORMAT_RGB");
        if (luminance() && version == "PTM_1.1") {
            put(bytes, 0, 9);
        } else if (luminance()) {
            put(bytes, 0, 6);
            put(bytes, 6, 9);
        } else {
            for (size_t c = 0; c < 3; ++c) put(bytes, 6 * c, 6 * c + 6);
        }
        return bytes;
    }
};

/// Planes: [3 terms], all terms of red, of green, of blue.
struct HshBytes {
    int width = 0, height = 0;
    std::vector<float> scale, bias;  ///< [terms]
    std::vector<std::vector<uint8_t>> planes;

    /// The published functions of the polar angle's cosine and the azimuth.
    static std::vector<double> functions(const Vec3d& l) {
        const double pi = std::numbers::pi, c = l.z(), c2 = c * c, phi = std::atan2(l.y(), l.x());
        return {1 / std::sqrt(2 * pi),
                std::sqrt(6 / pi) * (std::cos(phi) * std::sqrt(c - c2)),
                std::sqrt(3 / (2 * pi)) * (-1 + 2 * c),
                std::sqrt(6 / pi) * (std::sqrt(c - c2) * std::sin(phi)),
                std::sqrt(30 / pi) * (std::cos(2 * phi) * (-c + c2)),
                std::sqrt(30 / pi) * (std::cos(phi) * (-1 + 2 * c) * std::sqrt(c - c2)),
                std::sqrt(5 / (2 * pi)) * (1 - 6 * c + 6 * c2),
                std::sqrt(30 / pi) * ((-1 + 2 * c) * std::sqrt(c - c2) * std::sin(phi)),
                std::sqrt(30 / pi) * ((-c + c2) * std::sin(2 * phi)),
                2 * std::sqrt(35 / pi) * (std::cos(3 * phi) * std::pow(c - c2, 1.5)),
                std::sqrt(210 / pi) * (std::cos(2 * phi) * (-1 + 2 * c) * (-c + c2)),
                2 * std::sqrt(21 / pi) * (std::cos(phi) * std::sqrt(c - c2) * (1 - 5 * c + 5 * c2)),
                std::sqrt(7 / (2 * pi)) * (-1 + 12 * c - 30 * c2 + 20 * c2 * c),
                2 * std::sqrt(21 / pi) * (std::sqrt(c - c2) * (1 - 5 * c + 5 * c2) * std::sin(phi)),
                std::sqrt(210 / pi) * ((-1 + 2 * c) * (-c + c2) * std::sin(2 * phi)),
                2 * std::sqrt(35 / pi) * (std::pow(c - c2, 1.5) * std::sin(3 * phi))};
    }
    double value(size_t pixel, size_t channel, const Vec3d& l) const {
        const std::vector<double> at = functions(l);
        double sum = 0;
        for (size_t k = 0; k < scale.size(); ++k)
            sum += at[k] * (planes[channel * scale.size() + k][pixel] / 255.0 * double(scale[k]) + double(bias[k]));
        return sum;
    }
    std::string bytes(const char* line_end = "\n") const {
        std::string out = fmt::format("#HSH1.2{0}3{0}{1} {2} 3{0}{3} 2 1{0}", line_end, width, height, scale.size());
        for (const auto* list : {&scale, &bias})
            out.append(reinterpret_cast<const char*>(list->data()), list->size() * sizeof(float));
        for (size_t p = 0; p < size_t(width) * size_t(height); ++p)
            for (const auto& plane : planes) out.push_back(char(plane[p]));
        return out;
    }
};

/// Directions amid the hemisphere.
inline std::vector<Vec3d> some_lamps(size_t count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Vec3d> out;
    while (out.size() < count) {
        const double x = 2 * double(rng.uniform()) - 1, y = 2 * double(rng.uniform()) - 1;
        if (x * x + y * y < 0.95) out.emplace_back(x, y, std::sqrt(1 - x * x - y * y));
    }
    return out;
}

}  // namespace radiafit::testing
