#pragma once
#include "geometry/light.h"
#include "synthetic/sensor.h"

namespace radiafit {

enum class Shading {
    /// A pixel shows the texel that its centre sees, as seen and lit at the texel's centre. Whatever pixel the
    /// distributor gives a texel, it then holds that texel's own value.
    texel,
    /// A pixel averages what it covers, each point seen and lit from where it lies, as a camera does: only about what
    /// the model of its texel says.
    pixel
};

/// What only the ornament can vary.
struct OrnamentOptions {
    Sensor sensor = {};
    Shading shading = Shading::texel;
    Light::Kind light = Light::Kind::distant;
    bool operator==(const OrnamentOptions&) const = default;
};

}  // namespace radiafit
