// Hemispherical harmonics of order 2 as a texel-local model: 4 coefficients a channel.
#define HSH_ORDER 2
#include "model/hemispherical_harmonics.glsl"
#undef HSH_ORDER
