// Which photographs show a vertex, as bits: SEEN_ENTRIES entries of four numbers of 16 bits each.
#define BITS 16
uniform sampler2D photographs;  // where their cameras are
uniform sampler2D seen_from;
uniform sampler2D photograph_spacing;  // [vertex]: what angles are divided by
uniform int photograph_count;

/** The angle of src/core/eval/safe_views.h at a vertex, radians; 0 if no photograph shows it. */
float nearest_photograph(int vertex, vec3 position) {
    vec3 to_eye = direction_to(eye, position);
    float nearest = -2.0;
    for (int first = 0; first < photograph_count; first += BITS) {
        int number = first / BITS;
        int bits = int(table_entry(seen_from, vertex * SEEN_ENTRIES + number / 4)[number % 4]);
        for (int i = first; bits != 0; ++i, bits >>= 1)
            if ((bits & 1) != 0) {
                vec3 to_camera = normalize(table_entry(photographs, i).xyz - position);
                nearest = max(nearest, dot(to_camera, to_eye));
            }
    }
    if (nearest < -1.5) return 0.0;
    return acos(clamp(nearest, -1.0, 1.0)) / table_entry(photograph_spacing, vertex).x;
}
