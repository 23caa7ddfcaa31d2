#include "eval/outliers.h"

#include <gtest/gtest.h>

namespace radiafit::testing {
namespace {

/// Images of these mean squared errors, named by their places: "0", "1", ...
JudgeResult judged(const std::vector<double>& errors) {
    JudgeResult out;
    for (const double error : errors) {
        ImageFigures image;
        image.name = std::to_string(out.images.size());
        image.stored.squared = 300 * error;
        image.stored.values = 300;
        out.images.push_back(image);
    }
    return out;
}

using Names = std::vector<std::string>;

TEST(Outliers, AreFarAboveTheOthersSpread) {
    EXPECT_EQ(outlying_images(judged({1e-3, 1.2e-3, 0.9e-3, 5e-2, 1.1e-3, 1e-3, 1e-1})), (Names{"3", "6"}));
    // The same two amid images that differ much among themselves.
    EXPECT_EQ(outlying_images(judged({1e-4, 1e-3, 1e-2, 5e-2, 3e-4, 3e-2, 1e-1})), Names{});
}

TEST(Outliers, AreThreeTimesTheMedianAtLeast) {
    EXPECT_EQ(outlying_images(judged({1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 2.9e-3})), Names{});
    EXPECT_EQ(outlying_images(judged({1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 3.1e-3})), Names{"5"});
}

TEST(Outliers, AreNotSmallErrorsNorAmongFewImages) {
    EXPECT_EQ(outlying_images(judged({1e-3, 1.1e-3, 0.9e-3, 1e-3, 1e-9, 0})), Names{});
    EXPECT_EQ(outlying_images(judged({1e-3, 1e-3, 1e-3, 1})), Names{});
}

TEST(Outliers, AreNotImagesThatWereNotCompared) {
    JudgeResult result = judged({1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1});
    result.images.back().stored.values = 0;
    EXPECT_EQ(outlying_images(result), Names{});
}

}  // namespace
}  // namespace radiafit::testing
