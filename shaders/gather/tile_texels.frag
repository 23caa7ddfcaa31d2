#version 450 core
// variants: PRODUCT=-,1 DIAGONAL=-,1 SQUARE=-,1 MAXIMUM=-,1 TERMS=1,2 STORAGE=0,1 TURNS=-,7
// First level of the gather of Section 5.2.1 inside the tiles of one corner, at most 16 look-ups: a fragment sums ENTRIES
// texels of one tile, row after row. Band k of the target holds every tile's k-th share, each in ROWS rows; tiles that the
// mesh didn't draw loop over nothing and leave zero. TURNS, in place of ENTRIES: so many entries for every fragment; those beyond its
// share, and all of a tile that isn't drawn, are looked up and left out, as hardware without branches must.
// SQUARE: of a residual's loss. MAXIMUM: the largest instead of the sum. PRODUCT: the sum of r g_k ("multiplying the surface
// map gradient texture by the surface map texture and summing all products"); with DIAGONAL of g_k^2 where a sample is.
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#ifndef ENTRIES
#define ENTRIES 7
#endif
#ifndef ROWS
#define ROWS 64
#endif
uniform sampler2DArray source;
uniform usampler2D drawn;  // 1 + the tile, or 0
uniform int corner;
#ifdef PRODUCT
uniform MAPS surface_maps;
uniform int term;
#endif
layout(location = 0) out vec4 total;

const int texels = SIDE * (SIDE + 1) / 2;
#ifdef TURNS
const int share = TURNS;
#else
const int share = ENTRIES;
#endif

// Cell number k of a tile: row j begins after j SIDE - j (j - 1) / 2 others. The half keeps rounding away from whole rows.
ivec2 cell_of(int k) {
    float twice = float(2 * SIDE + 1);
    int j = int(0.5 * (twice - sqrt(twice * twice - 8.0 * (float(k) + 0.5))));
    return ivec2(k - j * SIDE + j * (j - 1) / 2, j);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int band = at.y / ROWS;
    uint tile = texelFetch(drawn, ivec2(at.x, at.y - band * ROWS), 0).r;
    ivec2 cell = cell_of(band * share);
    int entries = tile == 0u ? 0 : min(share, texels - band * share);
#ifdef TURNS
    ivec3 frame = tile_frame(max(int(tile), 1) - 1, SIDE);
    const int turns = share;
#else
    ivec3 frame = tile_frame(int(tile) - 1, SIDE);
    int turns = entries;
#endif
    vec4 sum = vec4(0.0);
    for (int i = 0; i < turns; ++i) {
#ifdef TURNS
        ivec2 place = frame.xy + frame.z * (i < entries ? cell : ivec2(0));
#else
        ivec2 place = frame.xy + frame.z * cell;
#endif
        vec4 x = texelFetch(source, ivec3(place, corner), 0);
#ifdef PRODUCT
        vec3 g = load(texelFetch(surface_maps, ivec3(place, corner * TERMS + term), 0));
        vec3 r = x.rgb;
#ifdef DIAGONAL
        x.rgb = LOSS_WEIGHTED(r * r, x.a * g * g);
#else
        x.rgb = LOSS_WEIGHTED(r * r, r) * g;
#endif
#endif
#ifdef SQUARE
        x = vec4(LOSS_VALUE(x.rgb * x.rgb), x.a);
#endif
#ifdef TURNS
        x = i < entries ? x : vec4(0.0);
#endif
#ifdef MAXIMUM
        sum = vec4(x.r > sum.r ? x.r : sum.r, x.g > sum.g ? x.g : sum.g, x.b > sum.b ? x.b : sum.b, 0.0);
#else
        sum += x;
#endif
        bool row_ends = cell.x + cell.y == SIDE - 1;
        cell = row_ends ? ivec2(0, cell.y + 1) : cell + ivec2(1, 0);
    }
    total = sum;
}
