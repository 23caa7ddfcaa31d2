// Hemispherical harmonics of order 4 as a texel-local model: 16 coefficients a channel.
#define HSH_ORDER 4
#include "model/hemispherical_harmonics.glsl"
#undef HSH_ORDER
