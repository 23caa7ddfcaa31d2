// Light files that are mirrored, turned or shuffled against their images, on made reliefs whose lamps are known.
#include "lamps/light_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "relief_dome.h"

namespace radiafit {
using namespace testing;
namespace {

using Kind = OrderFinding::Kind;
using Order = std::vector<uint32_t>;

/// Every other dome's file tells directions alone, as RTI files do, though the lamps are near.
std::vector<Light> file_of(const ReliefDome& dome, uint32_t seed) {
    std::vector<Light> said = dome.lamps;
    for (Light& light : said)
        if (seed % 2) light = {Light::Kind::distant, light.place.normalized(), Vec3d::Ones()};
    return said;
}

/// The file whose entry entry[i] is the lamp of image i.
std::vector<Light> reordered(const std::vector<Light>& right, const Order& entry) {
    std::vector<Light> said = right;
    for (size_t i = 0; i < entry.size(); ++i) said[entry[i]] = right[i];
    return said;
}

std::string told(const LightFinding& found) {
    std::string text;
    if (found.order)
        text +=
            "order of kind " + std::to_string(int(found.order->kind)) + ", by " + std::to_string(found.order->shift);
    if (found.turn)
        text += std::string(found.turn->mirrored ? "mirrored, " : "") + std::to_string(found.turn->degrees) +
                " degrees" + (found.turn_is_sure ? "" : ", unsure");
    return text.empty() ? "nothing" : text;
}

TEST(LightCheck, NothingIsNamedForRightFiles) {
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        ReliefDome dome(seed);
        const LightFinding found = check_lights(dome.stack(file_of(dome, seed)));
        EXPECT_FALSE(found.order || found.turn) << seed << ": " << told(found);
    }
}

class TurnedLights : public ::testing::Test {
protected:
    static void expect_named(uint32_t seed, const AxesTurn& turn) {
        ReliefDome dome(seed);
        std::vector<Light> said = file_of(dome, seed);
        for (Light& light : said) light.place.head<2>() = (turn.matrix() * light.place.head<2>()).eval();
        const LightFinding found = check_lights(dome.stack(said));
        const std::string what = std::to_string(seed) + ": " + told(found);
        ASSERT_TRUE(found.turn && found.turn_is_sure) << what;
        EXPECT_EQ(found.turn->mirrored, turn.mirrored) << what;
        const double tolerance = std::remainder(turn.degrees, 90.0) == 0 ? 0 : 8;
        EXPECT_LE(std::abs(std::remainder(found.turn->degrees - turn.degrees, 360.0)), tolerance) << what;
    }
};

TEST_F(TurnedLights, MirroredIsNamed) {
    for (uint32_t seed = 21; seed <= 40; ++seed) expect_named(seed, {true, seed % 4 < 2 ? 0.0 : 180.0});
}

TEST_F(TurnedLights, TurnedIsNamed) {
    for (uint32_t seed = 41; seed <= 60; ++seed) {
        const double degrees[] = {90, 180, 270, double(37 + 83 * seed % 280)};
        expect_named(seed, {false, degrees[seed % 4]});
    }
}

class ShuffledLights : public ::testing::Test {
protected:
    static void expect_named(ReliefDome& dome, uint32_t seed, const Order& entry, Kind kind) {
        LightStack stack = dome.stack(reordered(file_of(dome, seed), entry));
        if (kind == Kind::by_number) std::ranges::sort(stack.names);
        const LightFinding found = check_lights(stack);
        const std::string what = std::to_string(seed) + ": " + told(found);
        ASSERT_TRUE(found.order) << what;
        EXPECT_EQ(int(found.order->kind), int(kind)) << what;
        EXPECT_EQ(found.order->entry, kind == Kind::unknown ? Order() : entry) << what;
    }
};

TEST_F(ShuffledLights, OrderIsNamed) {
    for (uint32_t seed = 61; seed <= 80; ++seed) {
        ReliefDome dome(seed);
        const size_t count = dome.lamps.size();
        Order entry(count);
        std::iota(entry.begin(), entry.end(), 0u);
        Kind kind = Kind::unknown;
        if (seed % 5 == 0) std::ranges::shuffle(entry, dome.random());
        if (seed % 5 == 1) std::ranges::reverse(entry), kind = Kind::reversed;
        if (seed % 5 == 2) std::ranges::rotate(entry, entry.begin() + seed % 7 + 1), kind = Kind::shifted;
        if (seed % 5 == 3) {  // img10 before img2
            kind = Kind::by_number;
            std::vector<std::string> text;
            for (size_t i = 0; i < count; ++i) text.push_back("image" + std::to_string(i + 1));
            std::vector<std::string> sorted = text;
            std::ranges::sort(sorted);
            for (size_t i = 0; i < count; ++i) entry[i] = uint32_t(std::ranges::find(text, sorted[i]) - text.begin());
        }
        if (seed % 5 == 4) {  // two pairs whose lamps lie apart
            kind = Kind::swapped;
            const auto apart = [&](uint32_t a, uint32_t b) {
                return dome.lamps[a].place.normalized().dot(dome.lamps[b].place.normalized()) < std::cos(0.7);
            };
            for (uint32_t a = 0, pairs = 0; a < count && pairs < 2; ++a)
                for (uint32_t b = a + 1; b < count; ++b)
                    if (entry[a] == a && entry[b] == b && apart(a, b)) {
                        std::swap(entry[a], entry[b]);
                        ++pairs;
                        break;
                    }
        }
        expect_named(dome, seed, entry, kind);
    }
}

}  // namespace
}  // namespace radiafit
