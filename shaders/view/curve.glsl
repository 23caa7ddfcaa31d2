// From values on a curve to light (src/core/model/value_curve.h): CURVE is 0 for light
// itself, 1 for the square root, 2 for sRGB's.
#include "view/srgb.glsl"

vec3 light_on_curve(vec3 value) {
#if CURVE == 2
    return srgb_decoded(value);
#elif CURVE == 1
    return value * abs(value);
#else
    return value;
#endif
}

vec3 curve_of_light(vec3 light) {
#if CURVE == 2
    return srgb_encoded(light);
#elif CURVE == 1
    return sign(light) * sqrt(abs(light));
#else
    return light;
#endif
}
