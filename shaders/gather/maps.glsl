// How N-texel arrays (parameters, directions, gradients) are stored: STORAGE 0 is RGBA32F; 1 is binary16 rounded to
// nearest even, two packed pairs in RG32UI, because rendering into RGBA16F truncates; 2 is that truncating RGBA16F.
// TERMS is K; surface maps are layers [corner][term], view maps layers [term].
#ifndef STORAGE
#define STORAGE 0
#endif
#ifndef TERMS
#define TERMS 1
#endif
#ifndef VIEW_SIDE
#define VIEW_SIDE 8
#endif

// Problems per row of M-texel textures; a constant, because dividing by a variable costs more than a look-up.
#ifndef COLUMNS
#define COLUMNS 64
#endif

#if STORAGE == 1
#define MAPS usampler2DArray
#define STORED uvec2
vec3 load(uvec4 texel) { return vec3(unpackHalf2x16(texel.x), unpackHalf2x16(texel.y).x); }
#ifdef OWN_HALVES  // where packHalf2x16 rounds otherwise
uint half_of(float x) {
    uint bits = floatBitsToUint(x), sign = bits >> 16 & 0x8000u, size = bits & 0x7fffffffu;
    if (size > 0x7f800000u) return sign | 0x7e00u;   // not a number
    if (size >= 0x477ff000u) return sign | 0x7c00u;  // from 65520 on
    // Subnormal: a sum beyond 0.5 is rounded to the same places.
    precise float shifted = uintBitsToFloat(size) + 0.5;
    if (size < 0x38800000u) return sign | (floatBitsToUint(shifted) - 0x3f000000u);
    return sign | (size - 0x38000000u + 0x0fffu + (size >> 13 & 1u)) >> 13;
}
uvec2 store(vec3 x) { return uvec2(half_of(x.x) | half_of(x.y) << 16, half_of(x.z)); }
#else
uvec2 store(vec3 x) { return uvec2(packHalf2x16(x.xy), packHalf2x16(vec2(x.z, 0.0))); }
#endif
#else
#define MAPS sampler2DArray
#define STORED vec4
vec3 load(vec4 texel) { return texel.rgb; }
vec4 store(vec3 x) { return vec4(x, 0.0); }
#endif
#if STORAGE == 0
STORED store_positive(vec3 x) { return store(x); }
#else
STORED store_positive(vec3 x) { return store(max(x, vec3(6.0e-5))); }  // binary16 ends there
#endif
