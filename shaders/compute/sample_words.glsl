// A sample in one word, or WIDE in two: its colour, and what it is placed by.
#ifdef WIDE
#define WORD uvec2
#define WORD_PART rg
vec3 colour_of(uvec2 word) { return vec3(uvec3(word.x & 0xffffu, word.x >> 16, word.y & 0xffffu)); }
uint place_of(uvec2 word) { return word.y >> 16; }
#else
#define WORD uint
#define WORD_PART r
vec3 colour_of(uint word) { return vec3((uvec3(word) >> uvec3(0u, 8u, 16u)) & 255u) * 257.0; }
uint place_of(uint word) { return word >> 24; }
#endif
WORD sample_at(usamplerBuffer samples, uint i) { return texelFetch(samples, int(i)).WORD_PART; }
