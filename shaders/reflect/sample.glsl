// What a texel takes of an image (docs/formats.md, "What a light means"; model/texel_options.h says what counts). ONE_IMAGE:
// the pass has one; else it loops over several. ONE_CAMERA: all are seen from one place, so that texels know it beforehand.
// WEIGHTED: samples weigh as model/weight.glsl says.
#include "reflect/site.glsl"
#include "model/weight.glsl"
#ifdef ONE_IMAGE
#ifndef ONE_CAMERA
#define ONE_CAMERA
#endif
uniform vec4 lamp;
uniform vec4 exposure;
#else
uniform samplerBuffer views;  // of each image: lamp, exposure, camera centre
uniform int first_view;
#endif
#ifdef ONE_CAMERA
uniform vec4 camera_centre;
#endif

struct View {
    vec4 lamp;      // near: where, 1; distant: unit direction to it, 0
    // Target per 16-bit unit of a channel, times the squared distance where the lamp is near; the least unit that is
    // clipped.
    vec4 exposure;
    vec4 camera_centre;  // the camera's centre, 1; or unit direction to it, 0
};

// at: index of the first of the image's three entries in `views`; unused with ONE_IMAGE.
View view_at(int at) {
#ifdef ONE_IMAGE
    return View(lamp, exposure, camera_centre);
#else
    View view = View(texelFetch(views, at), texelFetch(views, at + 1), vec4(0.0));
#ifndef ONE_CAMERA
    view.camera_centre = texelFetch(views, at + 2);
#endif
    return view;
#endif
}

// The vector from a texel to `place` in the texel's frame, not of unit length; and its square length.
vec4 towards(vec4 place, Site site) {
    vec3 to = place.xyz - place.w * site.position;
    return vec4(to_local(site, to), dot(to, to));
}

vec3 unit(vec4 to) { return to.xyz * inversesqrt(to.w); }

Site site_at(ivec2 place) {
    Site site = read_site(place);
#ifdef ONE_CAMERA
    site.v = unit(towards(camera_centre, site));
#endif
    return site;
}

struct Sample {
    vec3 u;       // to the lamp, in the texel's frame
    vec3 target;
    bool counts;
    Terms terms;
#ifdef WEIGHTED
    float weight;
#define SAMPLE_WEIGHTED(s, x) ((s).weight * (x))
#else
#define SAMPLE_WEIGHTED(s, x) (x)
#endif
};

// channels: 16-bit units of the pixel that the texel takes.
Sample sample_of(View view, Site site, vec3 channels) {
    Sample s;
    vec4 light = towards(view.lamp, site);
    s.u = unit(light);
#ifdef ONE_CAMERA
    vec3 v = site.v;
#else
    vec3 v = unit(towards(view.camera_centre, site));
#endif
    s.target = channels * (light.w * view.exposure.rgb);
    s.terms = sample_terms(s.u, v);
#ifdef WEIGHTED
    s.weight = facing_weight(v.z);
#endif
    s.counts = s.u.z > 0.0 && v.z > 0.0 && all(lessThan(channels, vec3(view.exposure.w))) &&
               s.target.r + s.target.g + s.target.b >= site.darkness * s.u.z;
    return s;
}
