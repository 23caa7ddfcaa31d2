#include "eval/ssim.h"

#include <gtest/gtest.h>

#include "base/rng.h"

namespace radiafit::testing {
namespace {

JudgedView noise_view(int width, int height, uint64_t seed) {
    JudgedView view;
    view.width = width;
    view.height = height;
    Rng rng(seed);
    for (int i = 0; i < 3 * width * height; ++i) view.photograph.push_back(rng.uniform(0, 1));
    view.render = view.photograph;
    view.foreground.assign(size_t(width) * size_t(height), 1);
    return view;
}

TEST(Ssim, IsOneWhereImagesAreAlike) {
    const SsimSum same = ssim(noise_view(30, 20, 1));
    EXPECT_EQ(same.windows, 20u * 10u);
    EXPECT_NEAR(same.mean(), 1, 1e-12);
}

TEST(Ssim, OfFlatImagesComparesTheirLuma) {
    JudgedView view = noise_view(16, 16, 1);
    view.photograph.assign(view.photograph.size(), 0.5f);
    view.render.assign(view.render.size(), 0.3f);
    EXPECT_NEAR(ssim(view).mean(), (2 * 0.5 * 0.3 + 1e-4) / (0.25 + 0.09 + 1e-4), 1e-6);
}

TEST(Ssim, IsTheDefinitionInOneWindow) {
    JudgedView view = noise_view(11, 11, 2);
    Rng rng(3);
    for (float& x : view.render) x = rng.uniform(0, 1);
    double sum = 0, a = 0, b = 0, variance_a = 0, variance_b = 0, covariance = 0;
    const auto weight = [](int i) {
        return std::exp(-((i % 11 - 5) * (i % 11 - 5) + (i / 11 - 5) * (i / 11 - 5)) / 4.5);
    };
    const auto luma = [](const std::vector<float>& rgb, int i) {
        return 0.299 * double(rgb[size_t(3 * i)]) + 0.587 * double(rgb[size_t(3 * i + 1)]) +
               0.114 * double(rgb[size_t(3 * i + 2)]);
    };
    for (int i = 0; i < 121; ++i) {
        sum += weight(i);
        a += weight(i) * luma(view.render, i);
        b += weight(i) * luma(view.photograph, i);
    }
    a /= sum;
    b /= sum;
    for (int i = 0; i < 121; ++i) {
        const double p = luma(view.render, i) - a, q = luma(view.photograph, i) - b;
        variance_a += weight(i) / sum * p * p;
        variance_b += weight(i) / sum * q * q;
        covariance += weight(i) / sum * p * q;
    }
    const double expected =
        (2 * a * b + 1e-4) * (2 * covariance + 9e-4) / ((a * a + b * b + 1e-4) * (variance_a + variance_b + 9e-4));
    const SsimSum found = ssim(view);
    EXPECT_EQ(found.windows, 1u);
    EXPECT_NEAR(found.mean(), expected, 1e-9);
}

TEST(Ssim, OnlyOfWindowsInTheForeground) {
    JudgedView view = noise_view(30, 20, 4);
    view.foreground[10 * 30 + 5] = 0;
    view.render[3 * (10 * 30 + 5)] += 1;  // changes every window that has the pixel
    const SsimSum found = ssim(view);
    EXPECT_EQ(found.windows, 20u * 10u - 6u * 10u);  // x from 0 to 5, y from 0 to 9
    EXPECT_NEAR(found.mean(), 1, 1e-12);
    EXPECT_TRUE(std::isnan(ssim(noise_view(10, 40, 1)).mean()));
}

}  // namespace
}  // namespace radiafit::testing
