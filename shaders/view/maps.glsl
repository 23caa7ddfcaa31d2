// Maps of a page: values in steps, each channel scale * q + offset of a whole number q. q has 8 bits, which are in a layer
// of an array of textures, or 16, whose upper 8 are in another (src/tools/publish/coded_map.h). MAPS of them in all.
uniform sampler2DArray texel_maps;  // those in the layout of the atlas, or the grid
uniform vec4 map_scale[MAPS];       // of r, g, b; the layer of the lower bits
uniform vec4 map_offset[MAPS];      // of r, g, b; the layer of the upper bits, or -1

vec3 map_value(sampler2DArray maps, int map, ivec2 place) {
    vec4 scale = map_scale[map];
    vec4 offset = map_offset[map];
    vec3 q = 255.0 * texelFetch(maps, ivec3(place, int(scale.w)), 0).rgb;
    if (offset.w >= 0.0) q += 65280.0 * texelFetch(maps, ivec3(place, int(offset.w)), 0).rgb;
    return scale.rgb * floor(q + 0.5) + offset.rgb;
}

// The values of maps that hold signed square roots, in which dark values have finer steps.
vec3 squared(vec3 root) { return root * abs(root); }
