uniform vec3 up;  // where cameras have their upper edge

// As view_frame(): the normal, and the two directions across it, one as near to `up` as can be.
mat3 view_frame(vec3 normal) {
    vec3 across = cross(up, normal);
    float length_of = length(across);
    if (!(length_of > 1e-6)) return frame_of(normal);
    across /= length_of;
    return mat3(across, cross(normal, across), normal);
}
