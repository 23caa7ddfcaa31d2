// Problems that are single texels.
layout(std430) readonly buffer Problems { vec4 problems[]; };   // [texel] E_t, and two sums along d, penalties included
layout(std430) readonly buffer Products { float products[]; };  // [product][texel]

Given given_of(uint problem) {
    Given given;
    given.texels = 1.0;
    given.trial_error = problems[problem].x;
    given.line = LineSums(problems[problem].y, problems[problem].z, 0.0, 0.0);
    for (int i = 0; i < STEP_PRODUCTS; ++i)
        given.products[i] = i < product_count ? products[uint(i) * uint(problem_count) + problem] : 0.0;
    return given;
}
