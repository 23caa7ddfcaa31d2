#include "eval/ssim.h"

#include <array>
#include <cmath>

namespace radiafit {
namespace {

constexpr int side = 11, half = side / 2;
constexpr double deviation = 1.5;
constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;  // (K L)^2 with values up to L = 1

/// The window's weights along a row or a column; they add up to 1.
std::array<double, side> window_weights() {
    std::array<double, side> w{};
    double sum = 0;
    for (int i = 0; i < side; ++i)
        sum += w[size_t(i)] = std::exp(-0.5 * (i - half) * (i - half) / (deviation * deviation));
    for (double& x : w) x /= sum;
    return w;
}

std::vector<double> luma(const std::vector<float>& rgb) {
    std::vector<double> out(rgb.size() / 3);
    for (size_t i = 0; i < out.size(); ++i)
        out[i] = 0.299 * double(rgb[3 * i]) + 0.587 * double(rgb[3 * i + 1]) + 0.114 * double(rgb[3 * i + 2]);
    return out;
}

/// Number of foreground pixels above and left of each corner of the pixels. [height + 1][width + 1]
std::vector<uint32_t> foreground_above(const JudgedView& view) {
    const size_t w = size_t(view.width), row = w + 1;
    std::vector<uint32_t> out(row * (size_t(view.height) + 1), 0);
    for (size_t y = 0; y < size_t(view.height); ++y)
        for (size_t x = 0; x < w; ++x)
            out[(y + 1) * row + x + 1] =
                view.foreground[y * w + x] + out[y * row + x + 1] + out[(y + 1) * row + x] - out[y * row + x];
    return out;
}

/// Weighted means over the window around a pixel: of both images, of their squares and of their product.
struct Moments {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    void add(double weight, const Moments& m) {
        a += weight * m.a;
        b += weight * m.b;
        aa += weight * m.aa;
        bb += weight * m.bb;
        ab += weight * m.ab;
    }
    double similarity() const {
        return (2 * a * b + c1) * (2 * (ab - a * b) + c2) / ((a * a + b * b + c1) * ((aa - a * a) + (bb - b * b) + c2));
    }
};

}  // namespace

SsimSum ssim(const JudgedView& view) {
    SsimSum out;
    if (view.width < side || view.height < side) return out;
    static const std::array<double, side> weights = window_weights();
    const size_t w = size_t(view.width), h = size_t(view.height), row = w + 1;
    const std::vector<double> a = luma(view.render), b = luma(view.photograph);
    const std::vector<uint32_t> above = foreground_above(view);
    std::vector<Moments> columns(w);  // of the windows' columns, for a row of windows
    for (size_t y = 0; y + side <= h; ++y) {
        columns.assign(w, {});
        for (size_t j = 0; j < side; ++j)
            for (size_t x = 0; x < w; ++x) {
                const double p = a[(y + j) * w + x], q = b[(y + j) * w + x];
                columns[x].add(weights[j], {p, q, p * p, q * q, p * q});
            }
        for (size_t x = 0; x + side <= w; ++x) {
            const uint32_t inside = above[(y + side) * row + x + side] - above[y * row + x + side] -
                                    above[(y + side) * row + x] + above[y * row + x];
            if (inside < side * side) continue;
            Moments window;
            for (size_t i = 0; i < side; ++i) window.add(weights[i], columns[x + i]);
            out.sum += window.similarity();
            ++out.windows;
        }
    }
    return out;
}

}  // namespace radiafit
