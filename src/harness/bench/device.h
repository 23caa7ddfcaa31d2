#pragma once
#include <array>
#include <cstddef>

#include "base/rings.h"

/// What radiafit-bench times, and by whom.
namespace radiafit::harness {

enum class Device { cpu, one_thread, paper_passes, combined_passes, compute, redistributing, scattering };
/// As rows name them.
inline constexpr std::array device_names = {"cpu",
                                            "cpu, 1 thread",
                                            "fragment, paper passes",
                                            "fragment, combined passes",
                                            "compute",
                                            "compute, redistributing",
                                            "compute, redistributing, scattered"};
constexpr const char* name_of(Device device) { return device_names[size_t(device)]; }
constexpr bool needs_opengl(Device device) { return device != Device::cpu && device != Device::one_thread; }

/// The first of those whose programs run on the same units.
constexpr Device units_of(Device device) {
    if (device == Device::combined_passes) return Device::paper_passes;
    return device == Device::redistributing || device == Device::scattering ? Device::compute : device;
}

enum class Pass {
    gradient,     ///< errors and gradient of all problems, over all samples
    line,         ///< sums along the direction, over all samples
    iteration,    ///< of conjugate gradients: a line, a gradient, and all between
    distribution  ///< on the CPU: which texel takes which pixel, of all images
};
inline constexpr std::array pass_names = {"gradient", "line", "iteration", "distribution"};
constexpr const char* name_of(Pass pass) { return pass_names[size_t(pass)]; }

}  // namespace radiafit::harness
