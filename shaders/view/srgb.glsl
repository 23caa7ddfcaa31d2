// IEC 61966-2-1; f(-x) = -f(x).
vec3 srgb_decoded(vec3 stored) {
    vec3 x = abs(stored);
    return sign(stored) * mix(pow((x + 0.055) / 1.055, vec3(2.4)), x / 12.92, vec3(lessThanEqual(x, vec3(0.04045))));
}
vec3 srgb_encoded(vec3 light) {
    vec3 x = abs(light);
    return sign(light) * mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, vec3(lessThanEqual(x, vec3(0.0031308))));
}
