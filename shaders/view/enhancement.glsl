// What the fit shows, with specular enhancement where that is switched on. FIT_NORMALS: the number of a map of normals that tell more of
// the surface than those that it is shaded with; over a grid in the axes of its plane, without z.
#include "model/specular_enhancement.glsl"
uniform vec3 enhancement;  // as `strength` of that text; 1 and 0: off

vec3 highlight_normal(Site site) {
#if !defined(FIT_NORMALS)
    return site_normal(site);
#elif defined(GRID)
    vec2 across = surface_value(FIT_NORMALS, site).xy;
    float out_of = sqrt(max(0.0, 1.0 - dot(across, across)));
    return unit_or_zero(across.x * normalize(grid_right) - across.y * normalize(grid_down) + out_of * grid_normal);
#else
    return unit_or_zero(surface_value(FIT_NORMALS, site));
#endif
}

vec3 enhanced_value(vec3 light, Site site, vec3 to_lamp, vec3 to_viewer) {
    if (enhancement.x == 1.0 && enhancement.y == 0.0) return light;
    return enhanced_light(light, highlight_normal(site), to_lamp, to_viewer, enhancement);
}
