#version 450 core
// Marks the tiles that the mesh draws, one texel each.
layout(location = 0) out vec4 mark;
void main() { mark = vec4(1.0); }
