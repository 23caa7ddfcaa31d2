// A texel's colour for the picture's camera and lamp, in the space of the fit; or what is known of it, as a colour. The
// includer has, of its model,
//     vec3 model_value(Site site)
//     vec2 site_knowledge(Site site)     log2(1 + samples), root mean square residual
uniform int shown;         // 0: the model; 1: samples; 2: residuals; 3: uncertainty
uniform float most_shown;  // where the scale of these ends
out vec4 texel_colour;

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
    if (shown == 0) {
        texel_colour = vec4(model_value(site), 1.0);
        return;
    }
    vec2 known = site_knowledge(site);
    float value = shown == 1 ? known.x : known.y;
#ifdef UNCERTAINTY_MAP
    if (shown == 3) value = surface_value(UNCERTAINTY_MAP, site).x;
#endif
    vec3 colour = scale_colour(clamp(value / most_shown, 0.0, 1.0));
    if (known.x < 0.03) colour = vec3(0.85, 0.1, 0.35);  // no photograph shows it
#ifdef STORED_SRGB
    texel_colour = vec4(colour, 1.0);
#else
    texel_colour = vec4(srgb_decoded(colour), 1.0);
#endif
}
