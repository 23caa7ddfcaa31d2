// A table of numbers, four to an entry, row by row in a texture of 1024 columns (web/src/textures.js).
#define TABLE_COLUMN_BITS 10

vec4 table_entry(sampler2D table, int n) {
    return texelFetch(table, ivec2(n & ((1 << TABLE_COLUMN_BITS) - 1), n >> TABLE_COLUMN_BITS), 0);
}
