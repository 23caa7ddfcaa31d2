#version 300 es
// Adds a picture to those before it, by blending.
precision highp float;
precision highp sampler2D;
uniform sampler2D picture;
out vec4 light;
void main() { light = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
