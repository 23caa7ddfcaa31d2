// Hemispherical harmonics of order 3 as a texel-local model: 9 coefficients a channel.
#define HSH_ORDER 3
#include "model/hemispherical_harmonics.glsl"
#undef HSH_ORDER
