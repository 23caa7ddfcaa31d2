#version 450 core
// A device's peak of memory traffic: one large texture into another.
uniform sampler2D source;
layout(location = 0) out vec4 result;
void main() { result = texelFetch(source, ivec2(gl_FragCoord.xy), 0); }
