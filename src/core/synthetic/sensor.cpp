#include "synthetic/sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/error.h"
#include "base/rng.h"

namespace radiafit {
namespace {

/// Standard normal, by (seed, counter) alone (Box and Muller 1958).
double gaussian(uint64_t seed, uint64_t counter) {
    const double u = 1 - double(random_uniform(seed, 2 * counter)),
                 angle = double(random_uniform(seed, 2 * counter + 1));
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * angle);
}

template <class Stored>
void store(Stored value, size_t at, std::vector<uint8_t>& bytes) {
    std::memcpy(bytes.data() + at * sizeof(Stored), &value, sizeof(Stored));
}

}  // namespace

void check_sensor(const Sensor& sensor) {
    const Encoding e = sensor.encoding;
    if (e != Encoding::u8_srgb && e != Encoding::u16_linear && e != Encoding::f32_linear)
        throw UserError(fmt::format("the sensor stores u8-srgb, u16-linear or f32-linear, not {}", to_string(e)));
    for (const double noise : {sensor.read_noise, sensor.shot_noise})
        if (!(noise >= 0 && noise <= 1))
            throw UserError(fmt::format("noise of {} is out of range; choose one in [0, 1], white is 1", noise));
}

void Sensor::expose(const std::vector<Vec3f>& linear, uint64_t seed, uint64_t image,
                    std::vector<uint8_t>& bytes) const {
    const size_t channels = 3 * linear.size();
    const bool noisy = read_noise > 0 || shot_noise > 0;
    const uint64_t noise_seed = seed ^ 0x6e6f697365u;  // no other use of the seed counts through these numbers
    bytes.resize(channels * size_t(bytes_per_channel(encoding)));
    for (size_t i = 0; i < channels; ++i) {
        double x = double(linear[i / 3][Eigen::Index(i % 3)]);
        if (noisy)
            x += std::sqrt(read_noise * read_noise + shot_noise * shot_noise * std::max(x, 0.0)) *
                 gaussian(noise_seed, image * channels + i);
        const double stored = encoding == Encoding::f32_linear ? x : encode(encoding, std::clamp(x, 0.0, 1.0));
        if (encoding == Encoding::u8_srgb)
            store(uint8_t(std::lround(255 * stored)), i, bytes);
        else if (encoding == Encoding::u16_linear)
            store(uint16_t(std::lround(65535 * stored)), i, bytes);
        else
            store(float(stored), i, bytes);
    }
}

}  // namespace radiafit
