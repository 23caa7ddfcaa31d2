// Problems of light field maps: that of a vertex's colour channel c is at (3 x + c, y), where its vertex is (x, y).
uniform sampler2DArray map_sums;  // layers: Sum in fragment/problem_textures.h
uniform sampler2DArray sample_sums;
uniform sampler2DArray problem_constants;  // layer 0: 1/S-bar, ring texels

Given given_of(ivec2 at) {
    ivec2 vertex = ivec2(at.x / 3, at.y);
    int c = at.x % 3;
    vec4 constant = texelFetch(problem_constants, ivec3(vertex, 0), 0);
    float sums[5];
    for (int i = 0; i < 5; ++i) sums[i] = texelFetch(sample_sums, ivec3(vertex, i), 0)[c];
    float penalty = texelFetch(map_sums, ivec3(vertex, 0), 0)[c], curved = texelFetch(map_sums, ivec3(vertex, 1), 0)[c];
    Given given;
    given.texels = constant.g;
    given.trial_error = 0.5 * constant.r * sums[0] + penalty;
    given.line = LineSums(constant.r * sums[1] + curved, constant.r * sums[2] + curved, constant.r * sums[3],
                          constant.r * sums[4]);
    for (int i = 0; i < STEP_PRODUCTS; ++i) given.products[i] = texelFetch(products, ivec3(vertex, i), 0)[c];
    return given;
}
