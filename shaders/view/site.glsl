// Which texel a pixel shows, and where that lies. Of a mesh: the triangle's tile holds texel (i, j) = floor of the barycentric
// (b1, b2) times its side; two tiles share a rectangle of the atlas, the second one turned (geometry/atlas.h). Of a grid:
// the texel is the pixel of its photographs.
struct Site {
    ivec2 place;       // in the maps
    vec3 barycentric;  // of the texel's centre, on a mesh
};

#ifdef GRID
uniform vec4 image_to_target;  // scale of the photograph in the picture, 0, and where its upper left corner is
uniform vec2 target_size;
uniform vec3 grid_origin, grid_right, grid_down;  // world space: the first texel's centre, and steps to the next

bool find_site(out Site site) {
    vec2 pixel = vec2(gl_FragCoord.x, target_size.y - gl_FragCoord.y);
    vec2 texel = floor((pixel - image_to_target.zw) / image_to_target.x);
    site.place = ivec2(texel);
    site.barycentric = vec3(0.0);
    ivec2 size = textureSize(texel_maps, 0).xy;
    return all(greaterThanEqual(site.place, ivec2(0))) && all(lessThan(site.place, size));
}
vec3 site_position(Site site) {
    return grid_origin + float(site.place.x) * grid_right + float(site.place.y) * grid_down;
}
#else
uniform int largest_side, rectangles_per_row;
in vec2 barycentric;  // b1, b2
flat in int triangle;
flat in ivec4 corners;  // vertices, and the tile's side

bool find_site(out Site site) {
    int side = corners.w;
    int i = clamp(int(barycentric.x * float(side)), 0, side - 1);
    int j = clamp(int(barycentric.y * float(side)), 0, side - 1);
    int beyond = max(0, i + j - (side - 1));  // of the diagonal, by rounding only
    if (i > j) i -= beyond;
    else j -= beyond;
    // The diagonal cuts the cells i + j = side - 1 in half: their centre is a triangle's centroid.
    float centre = i + j == side - 1 ? 1.0 / 3.0 : 0.5;
    vec2 b = (vec2(float(i), float(j)) + centre) / float(side);
    site.barycentric = vec3(1.0 - b.x - b.y, b);
    int rectangle = triangle / 2;
    ivec2 origin = ivec2(rectangle % rectangles_per_row * largest_side, rectangle / rectangles_per_row * (largest_side + 1));
    site.place = origin + (triangle % 2 == 0 ? ivec2(i, j) : ivec2(largest_side - 1 - i, largest_side - j));
    return true;
}
#endif

// The surface maps' value at a site: that of its texel. Interpolation between texels would be here.
vec3 surface_value(int map, Site site) { return map_value(texel_maps, map, site.place); }
