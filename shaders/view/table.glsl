// A table of numbers, four to an entry, row by row in a texture.
vec4 table_entry(sampler2D table, int n) {
    int columns = textureSize(table, 0).x;
    return texelFetch(table, ivec2(n % columns, n / columns), 0);
}
