// Where a site lies, and its normal: a map of normals where the dataset has one (NORMAL_MAP is its number), else
// the plane's of a grid, or those of the triangle's corners, interpolated.
#ifdef GRID
uniform vec3 grid_normal;
#else
flat in vec3 position0, position1, position2;
flat in vec3 normal0, normal1, normal2;

vec3 site_position(Site site) {
    return site.barycentric.x * position0 + site.barycentric.y * position1 + site.barycentric.z * position2;
}
#endif

vec3 site_normal(Site site) {
#if defined(NORMAL_MAP)
    vec3 normal = surface_value(NORMAL_MAP, site);
#elif defined(GRID)
    vec3 normal = grid_normal;
#else
    vec3 normal = site.barycentric.x * normal0 + site.barycentric.y * normal1 + site.barycentric.z * normal2;
#endif
    float length_of = length(normal);
    return length_of > 0.001 ? normal / length_of : vec3(0.0);
}
