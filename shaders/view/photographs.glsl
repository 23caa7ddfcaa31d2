// Which photographs show a vertex, as bits: SEEN_ENTRIES entries of four numbers of 24 bits each.
#define BITS 24
uniform sampler2D photographs;  // where their cameras are
uniform sampler2D seen_from;
uniform int photograph_count;

/** Radians between the directions from a vertex to the picture's camera and to the nearest photograph's; 0 if none shows it. */
float nearest_photograph(int vertex, vec3 position) {
    vec3 to_eye = direction_to(eye, position);
    float nearest = -2.0;
    for (int first = 0; first < photograph_count; first += BITS) {
        int number = first / BITS;
        int bits = int(table_entry(seen_from, vertex * SEEN_ENTRIES + number / 4)[number % 4] + 0.5);
        for (int i = first; bits != 0; ++i, bits >>= 1)
            if ((bits & 1) != 0) {
                vec3 to_camera = normalize(table_entry(photographs, i).xyz - position);
                nearest = max(nearest, dot(to_camera, to_eye));
            }
    }
    return nearest < -1.5 ? 0.0 : acos(clamp(nearest, -1.0, 1.0));
}
