#version 450 core
// A device's peak of texture reads: 16 a turn, of 16 bytes each, from a texture of 32 x 32 texels that caches hold. With
// ones in the texture the result is 16 * turns.
uniform sampler2D source;
uniform int turns;
layout(location = 0) out vec4 result;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int turn = 0; turn < turns; ++turn)
        for (int i = 0; i < 16; ++i) sum += texelFetch(source, ivec2(at.x + i, at.y + turn) & 31, 0);
    result = sum;
}
