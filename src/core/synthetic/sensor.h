#pragma once
#include <cstdint>
#include <vector>

#include "base/linear.h"
#include "dataset/dataset.h"

namespace radiafit {

/// From linear light to stored bytes. A pixel's channel x, 1 = white, gets Gaussian noise of variance
/// read_noise^2 + shot_noise^2 max(x, 0), and is rounded to the nearest value that the encoding can store, within
/// [0, 1]; f32-linear is neither rounded nor cut off.
struct Sensor {
    Encoding encoding = Encoding::u16_linear;  ///< u8-srgb, u16-linear or f32-linear
    double read_noise = 0, shot_noise = 0;     ///< standard deviations: of darkness, and what white adds

    /// The noise depends on (seed, image, place in the image) alone. Reuses the storage of `bytes`.
    void expose(const std::vector<Vec3f>& linear, uint64_t seed, uint64_t image, std::vector<uint8_t>& bytes) const;
    bool operator==(const Sensor&) const = default;
};
/// Throws UserError for another encoding, or noise that is below 0 or above 1.
void check_sensor(const Sensor& sensor);

}  // namespace radiafit
