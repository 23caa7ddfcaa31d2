// Elements of single texels: three entries of one problem.
#include "gather/maps.glsl"
uniform int map;

ivec3 element_place() { return ivec3(ivec2(gl_FragCoord.xy), map); }
vec3 number_of(int number) { return vec3(number_at(number, ivec2(gl_FragCoord.xy))); }
vec3 product_of(int product) {
    return vec3(texelFetch(products, ivec3(ivec2(gl_FragCoord.xy), product), 0).r);
}
