#include "synthetic/look.h"

#include <algorithm>
#include <cmath>

#include "base/rng.h"
#include "synthetic/solid.h"

namespace radiafit {
namespace {

constexpr Gloss lacquer = {0.22f, 0.06f, 0.0f};
constexpr Gloss satin = {0.34f, 0.07f, 0.0f};
constexpr Gloss metal = {0.32f, 0.75f, 1.0f};

const Vec3f red(0.70f, 0.05f, 0.04f), orange(0.85f, 0.30f, 0.03f), yellow(0.85f, 0.66f, 0.06f),
    green(0.08f, 0.45f, 0.10f), teal(0.03f, 0.42f, 0.45f), blue(0.04f, 0.10f, 0.60f), violet(0.33f, 0.07f, 0.50f),
    pink(0.85f, 0.30f, 0.42f), white(0.80f, 0.78f, 0.74f), black(0.03f, 0.03f, 0.035f), gold(1.00f, 0.72f, 0.28f),
    copper(0.95f, 0.52f, 0.36f), silver(0.90f, 0.90f, 0.88f), skin(0.72f, 0.43f, 0.30f), rose(0.66f, 0.33f, 0.24f),
    brown(0.16f, 0.07f, 0.035f), umber(0.09f, 0.045f, 0.025f);

Vec3f unit(float x, float y, float z) { return Vec3f(x, y, z).normalized(); }

}  // namespace

const std::array<Lamp, lamp_count>& lamps() {
    static const std::array<Lamp, lamp_count> all = {{{unit(-0.55f, -0.65f, 0.75f), {1.30f, 1.16f, 0.98f}},   // key
                                                      {unit(0.85f, -0.35f, 0.35f), {0.27f, 0.36f, 0.52f}},    // fill
                                                      {unit(0.25f, 0.90f, 0.45f), {0.62f, 0.66f, 0.50f}},     // back
                                                      {unit(0.15f, -0.10f, 1.00f), {0.34f, 0.30f, 0.34f}}}};  // top
    return all;
}

Vec3f sky(const Vec3f& direction) {
    const float up = std::clamp((direction.z() + 0.25f) / 0.9f, 0.0f, 1.0f);
    const float blend = up * up * (3 - 2 * up);
    return (1 - blend) * Vec3f(0.08f, 0.065f, 0.05f) + blend * Vec3f(0.19f, 0.22f, 0.27f);
}

std::vector<Region> regions(const std::string& shape, uint64_t seed) {
    if (shape == "bust") {
        const std::vector<Vec3f> face = {skin, rose, skin, skin};
        return {{satin, face, {0, -0.22f, 0.36f}, 0.95f},
                {satin, face, {0, 0.02f, 0.06f}, 0.62f},
                {lacquer, {brown, umber, black, brown}, {0, 0.26f, 0.70f}, 1.25f},
                {lacquer, {red, white, blue, teal, yellow}, {0, 0.10f, -0.60f}, 1.40f},
                {metal, {gold, copper, gold, red}, {0, -0.30f, -0.40f}, 0.80f}};
    }
    const std::array<std::vector<Vec3f>, 3> palettes = {{{red, white, blue, yellow, black},
                                                         {teal, orange, violet, green, pink, white},
                                                         {gold, copper, silver, gold, red}}};
    const std::array<Gloss, 3> glosses = {lacquer, satin, metal};
    Rng rng(seed, 3);
    std::vector<Region> all;
    constexpr int count = 14;  // sites spread over the sphere, the three kinds in turn
    for (int i = 0; i < count; ++i) {
        const float z = 1 - (2 * float(i) + 1) / count, turn = 2.4f * float(i);
        const Vec3f even(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
        const Vec3f sway(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        const auto kind = size_t(i) % 3;
        all.push_back({glosses[kind], palettes[kind], 0.8f * even + 0.15f * sway, 1});
    }
    return all;
}

}  // namespace radiafit
