// A pixel's linear light, or what a fit knows of the place. The includer has, of its model,
//     vec3 model_value(Site site)   the value in the space of the fit
//     vec2 site_knowledge(Site site)     log2(1 + samples), root mean square residual
uniform int shown;           // 0: the model; 1: samples; 2: residuals
uniform float most_shown;    // of samples (log2) or residuals: where the scale ends
out vec4 light;              // premultiplied, and 1

// sRGB, IEC 61966-2-1; f(-x) = -f(x).
vec3 decoded(vec3 stored) {
    vec3 x = abs(stored);
    return sign(stored) * mix(pow((x + 0.055) / 1.055, vec3(2.4)), x / 12.92, vec3(lessThanEqual(x, vec3(0.04045))));
}

// Dark blue to yellow, of even lightness steps: a polynomial through matplotlib's "viridis" (Zucker, 2020).
vec3 scale_colour(float t) {
    const vec3 c0 = vec3(0.2777, 0.0054, 0.3340), c1 = vec3(0.1050, 1.4046, 1.3845), c2 = vec3(-0.3308, 0.2148, 0.0950),
               c3 = vec3(-4.6342, -5.7991, -19.3324), c4 = vec3(6.2282, 14.1799, 56.6905), c5 = vec3(4.7763, -13.7451, -65.3530),
               c6 = vec3(-5.4354, 4.6458, 26.3124);
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6)))));
}

void main() {
    Site site;
    if (!find_site(site)) discard;
#if defined(GRID) && defined(NORMAL_MAP)
    if (length(surface_value(NORMAL_MAP, site)) < 0.5) discard;  // not fitted
#endif
    if (shown == 0) {
        vec3 value = model_value(site);
#ifdef STORED_SRGB
        value = decoded(value);
#endif
        light = vec4(value, 1.0);
        return;
    }
    vec2 known = site_knowledge(site);
    vec3 colour = scale_colour(clamp((shown == 1 ? known.x : known.y) / most_shown, 0.0, 1.0));
    if (known.x < 0.03) colour = vec3(0.85, 0.1, 0.35);  // no photograph shows it
    light = vec4(decoded(colour), 1.0);
}
