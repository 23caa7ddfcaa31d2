#version 450 core
#include "distribute/tile.glsl"
void main() { place_tile(); }
