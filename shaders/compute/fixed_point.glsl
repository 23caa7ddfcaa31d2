// Signed fixed point of 64 bits in two words, the lower first: a number times its scale, a power of two by which no sum
// exceeds 2^61 (scales.comp). A scale of 0: there is none, for numbers aren't finite, and neither are sums.
uvec2 fixed_of(float value, float scale) {
    float x = scale > 0.0 ? roundEven(value * scale) : 0.0, size = abs(x);
    uint high = uint(size * (1.0 / 4294967296.0)), low = uint(size - float(high) * 4294967296.0);  // of 24 bits: exact
    return x < 0.0 ? uvec2(~low + 1u, ~high + uint(low == 0u)) : uvec2(low, high);
}
float number_of(uvec2 words, float scale) {
    bool negative = words.y > 0x7fffffffu;
    uvec2 size = negative ? uvec2(~words.x + 1u, ~words.y + uint(words.x == 0u)) : words;
    float x = float(size.y) * 4294967296.0 + float(size.x);
    return scale > 0.0 ? (negative ? -x : x) / scale : uintBitsToFloat(0x7f800000u);
}
