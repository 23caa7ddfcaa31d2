// The texel that is drawn, in the atlas or on the grid.
struct Site {
    ivec2 place;       // in the maps
    vec3 barycentric;  // of the texel's centre, on a mesh
};

vec3 surface_value(int map, Site site) { return map_value(texel_maps, map, site.place); }

#ifdef GRID
uniform vec3 grid_origin, grid_right, grid_down;  // world space: the first texel's centre, and steps to the next
uniform vec3 grid_normal;
uniform int texel_step;  // every so many texels are drawn, along rows and columns

bool find_site(out Site site) {
    site.place = ivec2(gl_FragCoord.xy) * texel_step;
    site.barycentric = vec3(0.0);
#ifdef NORMAL_MAP
    return length(surface_value(NORMAL_MAP, site)) > 0.5;  // others are not fitted
#else
    return true;
#endif
}
vec3 site_position(Site site) {
    return grid_origin + float(site.place.x) * grid_right + float(site.place.y) * grid_down;
}
vec3 plain_normal(Site site) { return grid_normal; }
#else
#include "view/atlas.glsl"
flat in int triangle;
flat in ivec4 corners;  // vertices, and the tile's side
flat in vec3 position0, position1, position2;
flat in vec3 normal0, normal1, normal2;

bool find_site(out Site site) {
    site.place = ivec2(gl_FragCoord.xy);
    ivec2 cell = turned(triangle, site.place - rectangle_of(triangle));
    int side = corners.w;
    if (cell.x + cell.y >= side) return false;
    // The diagonal cuts the cells i + j = side - 1 in half: their centre is a triangle's centroid.
    float centre = cell.x + cell.y == side - 1 ? 1.0 / 3.0 : 0.5;
    vec2 b = (vec2(cell) + centre) / float(side);
    site.barycentric = vec3(1.0 - b.x - b.y, b);
    return true;
}
vec3 site_position(Site site) {
    return site.barycentric.x * position0 + site.barycentric.y * position1 + site.barycentric.z * position2;
}
vec3 plain_normal(Site site) {
    return site.barycentric.x * normal0 + site.barycentric.y * normal1 + site.barycentric.z * normal2;
}
#endif

vec3 unit_or_zero(vec3 normal) {
    float length_of = length(normal);
    return length_of > 0.001 ? normal / length_of : vec3(0.0);
}

// The normal, unit or zero: from the dataset's map of normals where it has one (NORMAL_MAP is its number), else the
// plane's, or those of the triangle's corners, interpolated.
vec3 site_normal(Site site) {
#ifdef NORMAL_MAP
    return unit_or_zero(surface_value(NORMAL_MAP, site));
#else
    return unit_or_zero(plain_normal(site));
#endif
}
