// Problems that are single texels.
uniform sampler2DArray gradient_sums;  // over samples: of r^2 in the first layer's alpha
uniform sampler2D inverse_samples;  // 1 / S-bar
uniform sampler2D penalties;  // mu E_b, or its second derivative along d
uniform sampler2DArray line_sums;  // over samples along d: of a^2, of a^2 + r b

Given given_of(ivec2 at) {
    float inverse = texelFetch(inverse_samples, at, 0).r, penalty = texelFetch(penalties, at, 0).r;
    vec2 sum = inverse * texelFetch(line_sums, ivec3(at, 0), 0).rg + penalty;
    Given given;
    given.texels = 1.0;
    given.trial_error = 0.5 * inverse * texelFetch(gradient_sums, ivec3(at, 0), 0).a + penalty;
    given.line = LineSums(sum.x, sum.y, 0.0, 0.0);
    for (int i = 0; i < STEP_PRODUCTS; ++i) given.products[i] = texelFetch(products, ivec3(at, i), 0).r;
    return given;
}
