// The page's maps, tables and pictures as textures.
import * as THREE from "three";
import { bitmap_of, bytes_of, floats_of, wholes_of } from "./data.js";

export const table_columns = 1024;  // as in shaders/view/table.glsl

function exact(texture) {
    texture.minFilter = texture.magFilter = THREE.NearestFilter;
    texture.generateMipmaps = false;
    texture.needsUpdate = true;
    return texture;
}

/** A table of entries of four floats, row by row. */
export function table_texture(floats) {
    const entries = Math.ceil(floats.length / 4);
    const rows = Math.max(1, Math.ceil(entries / table_columns));
    const data = new Float32Array(4 * table_columns * rows);
    data.set(floats);
    return exact(new THREE.DataTexture(data, table_columns, rows, THREE.RGBAFormat, THREE.FloatType));
}

/** Layers of bytes, one image each. `advance` is called after each. */
export async function layers_texture(renderer, set, advance) {
    const gl = renderer.getContext();
    const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    if (Math.max(set.width, set.height) > most)
        throw new Error(`the maps have ${set.width} × ${set.height} texels; this device draws at most ${most} a side`);
    const most_layers = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
    if (set.layers.length > most_layers)
        throw new Error(`the maps have ${set.layers.length} layers; this device draws at most ${most_layers}`);
    const texture = exact(new THREE.DataArrayTexture(null, set.width, set.height, set.layers.length));
    texture.source.dataReady = false;  // three.js makes it, and the images come one after another
    renderer.initTexture(texture);
    const name = renderer.properties.get(texture).__webglTexture;
    for (let layer = 0; layer < set.layers.length; ++layer) {
        const bitmap = await bitmap_of(set.layers[layer]);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, name);
        gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
        gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
        gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
        gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, set.width, set.height, 1, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
        bitmap.close();
        advance();
    }
    renderer.resetState();
    return texture;
}

/** A photograph, or another picture of a view. */
export async function picture_texture(name) {
    const texture = new THREE.Texture(await bitmap_of(name));
    texture.colorSpace = THREE.NoColorSpace;
    texture.flipY = false;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.needsUpdate = true;
    return texture;
}

/** Corners of a mesh's triangles, one after another, and the tables that go with them (shaders/view/triangles.glsl). */
export async function mesh_tables(mesh) {
    const vertices = await floats_of(mesh.vertices);  // position and normal of each
    const triangles = await wholes_of(mesh.triangles);
    const sides = mesh.sides ? await bytes_of(mesh.sides) : null;
    const across = mesh.across ? await wholes_of(mesh.across) : null, none = 0xffffffff;
    const vertex_count = vertices.length / 6, triangle_count = triangles.length / 3;
    const vertex_entries = new Float32Array(8 * vertex_count);
    for (let v = 0; v < vertex_count; ++v)
        for (let i = 0; i < 3; ++i) {
            vertex_entries[8 * v + i] = vertices[6 * v + i];
            vertex_entries[8 * v + 4 + i] = vertices[6 * v + 3 + i];
        }
    const triangle_entries = new Float32Array(8 * triangle_count), corners = new Float32Array(9 * triangle_count);
    for (let t = 0; t < triangle_count; ++t) {
        for (let c = 0; c < 3; ++c) {
            const v = triangles[3 * t + c];
            const other = across ? across[3 * t + c] : none;
            triangle_entries[8 * t + c] = v;
            triangle_entries[8 * t + 4 + c] = other === none ? -1 : other;
            for (let i = 0; i < 3; ++i) corners[9 * t + 3 * c + i] = vertices[6 * v + i];
        }
        triangle_entries[8 * t + 3] = sides ? sides[t] : mesh.largest_side;
    }
    return { vertex_count, corners, vertices: table_texture(vertex_entries), triangles: table_texture(triangle_entries) };
}
