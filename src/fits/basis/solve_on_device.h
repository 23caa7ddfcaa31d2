#pragma once
#include <functional>
#include <span>
#include <vector>

#include "basis/basis_blocks.h"

/// Texels on a learned basis, solved by compute shaders of the current context (shaders/compute/basis.comp).
namespace radiafit::fits {

/// What is seen of a texel, in one image.
struct SeenColour {
    Vec3f direction;  ///< of view or lamp, in the basis' frame
    Vec3f colour;
};

struct DeviceBasis {
    std::span<const float> numbers;  ///< of all blocks
    int rank;
    float noise;
    /// By lamp direction: three rows a sample and one z, in place of one row and a z for each channel, and kernels of
    /// this length at these lamps in place of polynomials. `numbers` are what they are multiplied by.
    std::span<const Vec3f> lamps = {};
    float length = 0;
    /// With half vectors: those of the lamps, and the kernels' length over them and share; else none.
    std::span<const Vec3f> halves = {};
    float half_length = 0, half_share = 0;
    bool by_light() const { return !lamps.empty(); }
    bool by_half() const { return !halves.empty(); }
};

struct DeviceTexel {
    uint32_t number, block;
    std::vector<SeenColour> samples;
    std::vector<Vec3f> halves = {};  ///< [samples] half vectors, where the basis has some
};

/// Texels come in units, some of which are solved at a time: samples_of(unit) says how many samples and texels one has,
/// read(unit, texels) fills in those that have samples, several units at a time. take(number, z, error): of a texel,
/// z [rank][3], or by light [rank], and 1/2 sum r^2.
struct DeviceUnits {
    size_t count;
    struct Size {
        size_t samples, texels;
    };
    std::function<Size(size_t unit)> size_of;
    std::function<void(size_t unit, std::vector<DeviceTexel>& texels)> read;
    std::function<void(uint32_t number, std::span<const float> z, float error)> take;
};
void solve_on_device(const DeviceBasis& basis, const DeviceUnits& units);

/// Bytes of the units that are solved at a time, on the device and before and after on the host.
uint64_t bytes_on_device();

}  // namespace radiafit::fits
