// Directions in the local frames of surface points, as geometry/mesh.h's Frame: x tangent, y bitangent, z normal.
uniform vec4 eye;  // the camera: its place and 1, or the direction to a distant one and 0

vec3 direction_to(vec4 place, vec3 from) { return place.w > 0.5 ? normalize(place.xyz - from) : place.xyz; }

mat3 frame_of(vec3 normal) {
    vec3 tangent = normalize(cross(abs(normal.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0), normal));
    return mat3(tangent, cross(normal, tangent), normal);
}
vec3 to_local(mat3 frame, vec3 direction) { return direction * frame; }
