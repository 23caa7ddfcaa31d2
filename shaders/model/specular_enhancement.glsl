// Specular enhancement (Malzbender, Gelb and Wolters 2001): of linear `light` a share stays, and a share of its luminance (Rec. 709) is
// added as a highlight, the cosine between the normal and the half vector to some power (Blinn 1977). Directions to lamp and
// viewer are unit, the normal too, or 0, which has no highlight. strength: the two shares and the power.
SHARED_FN real3 enhanced_light(real3 light, real3 normal, real3 to_lamp, real3 to_viewer, real3 strength) {
    real3 half_way = to_lamp + to_viewer;
    real along = normal.x * half_way.x + normal.y * half_way.y + normal.z * half_way.z;
    real length_of = sqrt(half_way.x * half_way.x + half_way.y * half_way.y + half_way.z * half_way.z);
    real cosine = max(along, real(0.0)) / max(length_of, real(1.0e-6));
    real luminance = real(0.2126) * light.x + real(0.7152) * light.y + real(0.0722) * light.z;
    real highlight = strength.y * luminance * pow(min(cosine, real(1.0)), strength.z);
    return strength.x * light + real3(highlight, highlight, highlight);
}
