// Colours by lamp direction on a learned basis (src/fits/lightbasis/light_basis.h): sums of kernels at reference lamps; with
// HALF by half vectors, too.
// Maps: from 0 on Z_MAPS of z; at BLOCK_MAP the number of the texel's block of the surface; behind it what is known. Tables: the
// reference lamps, with HALF each followed by its half vector; for every block and lamp what its kernel is multiplied by in the
// mean and the functions, the three channels of each. The first of ALL_TERMS terms are the mean and the functions. The includer has
//     vec3 light_of_basis(Site site, vec3 position, vec3 to_lamp, vec3 value, float darker)
//         per irradiance, of a value on the curve
uniform sampler2D basis_table, lamp_table;
uniform float length_between;                       // of the kernel
uniform vec4 lamp;                                  // as eye
uniform vec3 intensity;                             // linear, of a near lamp at distance 1
uniform vec3 lamp_seen, lamp_inside;                // from the surface's middle; the nearest direction amid those fitted
#ifdef HALF
uniform float half_length, half_share;              // of the kernel
uniform vec3 camera_seen, camera_inside;            // as of the lamp
#endif
uniform vec3 frame_x, frame_y, frame_z;             // that directions are in, over a grid
uniform vec3 white;                                 // light of which the curve's 1 is
uniform float least_cosine, most_bright;            // where lamps leave the directions that were fitted
uniform float term[ALL_TERMS];

vec2 site_knowledge(Site site) { return surface_value(BLOCK_MAP + 1, site).xy; }

/** As the direction at the surface's middle, `seen`, is turned back amid those that were fitted. */
vec3 turned_inside(vec3 direction, vec3 seen, vec3 inside) {
    vec3 both = seen + inside;
    return direction - both * (dot(both, direction) / max(1.0 + dot(seen, inside), 1e-6)) + 2.0 * inside * dot(seen, direction);
}

/** On the curve. inside, view_inside: to lamp and camera, turned back; the latter is read with HALF alone. */
vec3 basis_value(Site site, mat3 frame, vec3 inside, vec3 view_inside) {
    vec3 local = to_local(frame, inside);
#ifdef HALF
    vec3 between = half_vector(local, to_local(frame, view_inside));
#endif
    vec3 along[RANK + 1];  // the mean, then the functions, at the lamp
    for (int k = 0; k <= RANK; ++k) along[k] = vec3(0.0);
    int entry = int(surface_value(BLOCK_MAP, site).x + 0.5) * LAMPS * (RANK + 1);
    for (int i = 0; i < LAMPS; ++i) {
#ifdef HALF
        float weight = light_pair_kernel(table_entry(lamp_table, 2 * i).xyz, table_entry(lamp_table, 2 * i + 1).xyz, local, between,
                                         length_between, half_length, half_share);
#else
        float weight = light_kernel(table_entry(lamp_table, i).xyz, local, length_between);
#endif
        for (int k = 0; k <= RANK; ++k, ++entry) along[k] += weight * table_entry(basis_table, entry).xyz;
    }
    vec3 value = term[0] * along[0];
    for (int m = 0; m < Z_MAPS; ++m) {
        vec3 z = surface_value(m, site);
        for (int i = 0; i < 3 && 3 * m + i < RANK; ++i) value += term[3 * m + i + 1] * z[i] * along[3 * m + i + 1];
    }
    return value;
}

/** How much of it is left beyond the lamps that were fitted. */
float darkening(vec3 facing, vec3 direction, vec3 inside) {
    if (lamp_seen == lamp_inside) return 1.0;
    return min(most_bright, max(0.0, dot(facing, direction)) / max(least_cosine, dot(facing, inside)));
}

vec3 irradiance_at(vec3 position) {
    return lamp.w > 0.5 ? intensity / dot(lamp.xyz - position, lamp.xyz - position) : intensity;
}

vec3 model_value(Site site) {
    vec3 position = site_position(site);
    vec3 direction = direction_to(lamp, position), inside = turned_inside(direction, lamp_seen, lamp_inside);
    vec3 view_inside = vec3(0.0);
#ifdef HALF
    view_inside = turned_inside(direction_to(eye, position), camera_seen, camera_inside);
#endif
#ifdef GRID
    mat3 frame = mat3(frame_x, frame_y, frame_z);
    vec3 facing = frame_z;
#else
    vec3 facing = site_normal(site);
    mat3 frame = view_frame(facing);
    if (!(dot(facing, direction) > 0.0)) return vec3(0.0);
#endif
    vec3 value = basis_value(site, frame, inside, view_inside);
    vec3 light = light_of_basis(site, position, direction, value, darkening(facing, direction, inside)) * irradiance_at(position);
    return enhanced_value(light, site, direction, direction_to(eye, position));
}
