// Where a texel lies. C++: geometry/mesh.h, make_frame().
uniform sampler2DArray surface;  // 0: position, 1 where it may be fitted; 1: unit normal, darkness

struct Site {
    vec3 position;
    vec3 tangent, bitangent, normal;
    bool usable;
    float darkness;  // of u_z: samples with a smaller sum of channels lie in shadow
    vec3 v;          // to the camera, in the texel's frame, if all images of a pass share it (reflect/sample.glsl)
};

Site read_site(ivec2 place) {
    vec4 position = texelFetch(surface, ivec3(place, 0), 0);
    vec4 normal = texelFetch(surface, ivec3(place, 1), 0);
    vec3 axis = abs(normal.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    vec3 tangent = normalize(cross(axis, normal.xyz));
    return Site(position.xyz, tangent, cross(normal.xyz, tangent), normal.xyz, position.w != 0.0, normal.w, vec3(0.0));
}

vec3 to_local(Site site, vec3 d) { return vec3(dot(site.tangent, d), dot(site.bitangent, d), dot(site.normal, d)); }
