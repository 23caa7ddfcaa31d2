// A fit of colours by view direction within what bounds it off its photographs (src/core/eval/safe_views.h). Maps: from MEAN_MAP
// on, a texel's mean colour over its photographs and how far it reaches from there, both as roots where values are linear. The
// last of a vertex's VERTEX_ENTRIES numbers is its angle to the nearest photograph, less where these are far apart.
// Without MEAN_MAP there are no bounds.
uniform sampler2D vertex_values;
#ifdef MEAN_MAP
uniform float bounded;  // 0: terms are left out, so that the fit isn't shown
uniform float apart, fade, bound_from, bound_within, most;

vec3 bound_value(int map, Site site) {
#ifdef STORED_SRGB
    return surface_value(map, site);
#else
    return squared(surface_value(map, site));
#endif
}

float angle_at(int vertex) { return table_entry(vertex_values, vertex * VERTEX_ENTRIES + VERTEX_ENTRIES - 1).x; }

vec3 safe_view(Site site, vec3 colour) {
    float angle = dot(site.barycentric, vec3(angle_at(corners.x), angle_at(corners.y), angle_at(corners.z)));
    if (angle <= bound_from || bounded < 0.5) return colour;
    vec3 mean = bound_value(MEAN_MAP, site), reach = most * bound_value(MEAN_MAP + 1, site);
    vec3 within = max(min(colour, mean + reach), mean - reach);
    float held = min(1.0, (angle - bound_from) / bound_within);
    float share = clamp(1.0 - (angle - apart) / fade, 0.0, 1.0);
    vec3 fitted = held < 1.0 ? mix(colour, within, held) : within;
    return share > 0.0 ? mix(mean, fitted, share) : mean;
}
#else
vec3 safe_view(Site site, vec3 colour) { return colour; }
#endif
