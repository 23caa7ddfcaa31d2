#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/texel_texts.h"

namespace radiafit {
namespace {

template <class Text>
auto functions_at(double height, double azimuth) {
    const double across = std::sqrt(1 - height * height);
    const typename Text::real3 u = {across * std::cos(azimuth), across * std::sin(azimuth), height};
    return Text::basis({}, Text::sample_terms(u, {0, 0, 1}));
}

// By the trapezoid rule around the axis, and Gauss and Legendre's of five points along it: exact for what polynomials
// of degree 9 are there.
TEST(HemisphericalHarmonics, AreOrthonormalOverTheHemisphere) {
    using Text = texel_text::hsh5<double>;
    constexpr int count = Text::basis_count, around = 32;
    const double nodes[5] = {0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640, -0.9061798459386640};
    const double weights[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                               0.2369268850561891};
    double products[count][count] = {};
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < around; ++j) {
            const auto h = functions_at<Text>((nodes[i] + 1) / 2, 2 * std::numbers::pi * j / around);
            const double area = weights[i] / 2 * 2 * std::numbers::pi / around;
            for (int a = 0; a < count; ++a)
                for (int b = 0; b < count; ++b) products[a][b] += area * h.x[a] * h.x[b];
        }
    for (int a = 0; a < count; ++a)
        for (int b = 0; b < count; ++b) EXPECT_NEAR(products[a][b], a == b, 1e-8) << a << ", " << b;
}

TEST(HemisphericalHarmonics, OfLowerOrderAreTheFirstOnes) {
    const auto most = functions_at<texel_text::hsh5<double>>(0.3, 0.8);
    const auto expect_first = [&](const auto& fewer) {
        for (size_t k = 0; k < std::size(fewer.x); ++k) EXPECT_EQ(fewer.x[k], most.x[k]) << k;
    };
    expect_first(functions_at<texel_text::hsh2<double>>(0.3, 0.8));
    expect_first(functions_at<texel_text::hsh3<double>>(0.3, 0.8));
    expect_first(functions_at<texel_text::hsh4<double>>(0.3, 0.8));
}

}  // namespace
}  // namespace radiafit
