#version 300 es
// A pixel's linear light: the texel that it shows, or the mix of texels (geometry/surface_lookup.h), in the colours
// that the fit's pass has drawn. On a grid the texel is the pixel of its photographs; where these are magnified, the mix of the
// four whose centres are around.
// variants: GRID=-,1 STORED_SRGB=-,1
// variants: LINEAR=-,1 STORED_SRGB=-,1
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/srgb.glsl"
uniform sampler2D texels;
uniform vec2 target_size;
out vec4 light;  // premultiplied, and 1

vec4 light_of(vec4 colour) {
#ifdef STORED_SRGB
    colour.rgb = srgb_decoded(colour.rgb);
#endif
    return colour;
}

#ifdef GRID
uniform vec4 image_to_target;  // scale of the photograph in the picture, 0, and where its upper left corner is
uniform int texel_step;  // every so many are in `texels`, along rows and columns

vec4 magnified(vec2 at) {
    ivec2 first = ivec2(floor(at - 0.5)), most = textureSize(texels, 0) - 1;
    vec2 share = at - 0.5 - vec2(first);
    vec4 sum = vec4(0.0);  // premultiplied
    for (int k = 0; k < 4; ++k) {
        ivec2 corner = ivec2(k & 1, k >> 1);
        vec4 one = light_of(texelFetch(texels, clamp(first + corner, ivec2(0), most), 0));
        vec2 weight = mix(1.0 - share, share, vec2(corner));
        sum += weight.x * weight.y * one.a * vec4(one.rgb, 1.0);
    }
    return sum.a > 0.0 ? vec4(sum.rgb / sum.a, sum.a) : vec4(0.0);
}

vec4 light_here() {
    vec2 pixel = vec2(gl_FragCoord.x, target_size.y - gl_FragCoord.y);
    vec2 at = (pixel - image_to_target.zw) / image_to_target.x;
    ivec2 texel = ivec2(floor(at));
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel / texel_step, textureSize(texels, 0)))) return vec4(0.0);
    if (image_to_target.x > 1.0 && texel_step == 1) return magnified(at);
    return light_of(texelFetch(texels, texel / texel_step, 0));
}
#else
#include "view/table.glsl"
#include "view/triangles.glsl"
#include "view/atlas.glsl"
flat in int triangle;
flat in ivec4 corners;  // vertices, and the tile's side
flat in ivec3 across;
flat in vec3 clip0, clip1, clip2;

// Barycentric coordinates (b1, b2) of the pixel's centre, perspective-correct. Interpolated ones would be those of
// corners that the rasterizer moved to the next sixteenth of a pixel or so, and fall into other texels.
vec2 barycentric_here() {
    vec2 at = 2.0 * gl_FragCoord.xy / target_size - 1.0;
    vec2 a = clip0.xy - at * clip0.z, b = clip1.xy - at * clip1.z, c = clip2.xy - at * clip2.z;
    vec3 share = vec3(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x);
    return share.yz / (share.x + share.y + share.z);
}

vec4 texel_at(int of_triangle, ivec2 cell) {
    return texelFetch(texels, rectangle_of(of_triangle) + turned(of_triangle, cell), 0);
}

#ifdef LINEAR
vec3 clamped(vec3 at) {
    at = max(at, 0.0);
    return at / (at.x + at.y + at.z);
}
vec3 in_lattice(int side, vec3 at) {
    float n = float(side);
    vec2 b = at.yz * n - 0.5;
    b += max(0.0, b.x + b.y - (n - 2.0)) / 4.0;
    return vec3(n - 1.0 - b.x - b.y, b) / (n - 1.0);
}
vec4 tile_colour(int of_triangle, int side, vec3 lattice) {
    vec2 b = lattice.yz * float(side - 1);
    ivec2 cell = clamp(ivec2(b), ivec2(0), ivec2(side - 2));
    if (cell.x + cell.y > side - 2) {
        if (b.x - float(cell.x) < b.y - float(cell.y)) cell.x -= 1;
        else cell.y -= 1;
    }
    float u = b.x - float(cell.x), v = b.y - float(cell.y);
    bool near_corner = u + v <= 1.0 || cell.x + cell.y == side - 2;
    vec4 across_u = max(0.0, near_corner ? u : 1.0 - v) * texel_at(of_triangle, cell + ivec2(1, 0));
    vec4 across_v = max(0.0, near_corner ? v : 1.0 - u) * texel_at(of_triangle, cell + ivec2(0, 1));
    return across_u + across_v + abs(u + v - 1.0) * texel_at(of_triangle, near_corner ? cell : cell + ivec2(1, 1));
}

vec4 colour_here() {
    int side = corners.w;
    vec2 barycentric = barycentric_here();
    vec3 at = clamped(vec3(1.0 - barycentric.x - barycentric.y, barycentric)), lattice = in_lattice(side, at);
    vec3 beyond;  // the outermost centres: 0 there, 1 on the edge
    for (int c = 0; c < 3; ++c) {
        float m = -lattice[c] * float(side - 1);
        beyond[c] = m > 0.0 ? m / (m + at[c] * float(side)) : 0.0;
    }
    vec4 sum = vec4(0.0);
    float own = 1.0;
    for (int c = 0; c < 3; ++c) {
        int other = across[c];
        if (beyond[c] == 0.0 || other < 0) continue;
        float next = max(beyond[(c + 1) % 3], beyond[(c + 2) % 3]);
        float share = beyond[c] * (1.0 - next) / (2.0 * max(1.0 - beyond[c] * next, 1e-6));
        ivec4 theirs = corners_of(other);
        vec3 on_edge = vec3(0.0);
        for (int k = 0; k < 3; ++k)
            for (int o = 0; o < 3; ++o)
                if (k != c && corners[k] == theirs[o]) on_edge[o] = at[k];
        sum += share * tile_colour(other, theirs.w, clamped(in_lattice(theirs.w, clamped(on_edge))));
        own -= share;
    }
    return sum + own * tile_colour(triangle, side, clamped(lattice));
}
#else
vec4 colour_here() {
    int side = corners.w;
    vec2 barycentric = barycentric_here();
    int i = clamp(int(barycentric.x * float(side)), 0, side - 1);
    int j = clamp(int(barycentric.y * float(side)), 0, side - 1);
    int beyond = max(0, i + j - (side - 1));  // of the diagonal, by rounding only
    if (i > j) i -= beyond;
    else j -= beyond;
    return texel_at(triangle, ivec2(i, j));
}
#endif
vec4 light_here() { return light_of(colour_here()); }
#endif

void main() {
    vec4 here = light_here();
    if (here.a < 0.5) discard;
    light = vec4(here.rgb, 1.0);
}
