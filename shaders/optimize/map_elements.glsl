// Elements of light field maps: three problems' entries, a vertex's colour channels.
#include "optimize/site.glsl"
uniform int term;

ivec3 element_place() { return site_texel(term); }
vec3 number_of(int number) {
    ivec2 first = ivec2(3, 1) * site_problem();
    return vec3(number_at(number, first), number_at(number, first + ivec2(1, 0)), number_at(number, first + ivec2(2, 0)));
}
vec3 product_of(int product) { return texelFetch(products, ivec3(site_problem(), product), 0).rgb; }
