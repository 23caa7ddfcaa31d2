// Hemispherical harmonics of order 5 as a texel-local model: 25 coefficients a channel.
#define HSH_ORDER 5
#include "model/hemispherical_harmonics.glsl"
#undef HSH_ORDER
