// Draws the fit as `radiafit render` does, by the shaders that the page brings along: the colours of all texels that can be seen;
// from these the surface at some points of every pixel, one picture per point, summed in linear light; then the screen's areas
// from the sum and from stored pictures.
import * as THREE from "three";
import { floats_of } from "./data.js";
import { layers_texture, mesh_tables, table_columns, table_texture } from "./textures.js";
import { add, dot } from "./vectors.js";

const without_version = (text) => text.replace(/^#version[^\n]*\n/, "");

function material_of(vertex, fragment, uniforms, more = {}) {
    return new THREE.RawShaderMaterial({
        glslVersion: THREE.GLSL3,
        vertexShader: without_version(vertex),
        fragmentShader: without_version(fragment),
        uniforms,
        ...more,
    });
}

/** A scene of one mesh, which is always drawn. */
function scene_of(geometry, material) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    const scene = new THREE.Scene();
    scene.matrixWorldAutoUpdate = false;
    scene.add(mesh);
    return scene;
}

function whole_geometry() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    return geometry;
}

const with_place = (place, near) => new THREE.Vector4(...place, near ? 1 : 0);

export class Renderer {
    constructor(canvas, page) {
        this.page = page;
        this.three = new THREE.WebGLRenderer({ canvas, antialias: false, alpha: false, depth: false, stencil: false });
        this.three.autoClear = false;
        this.three.outputColorSpace = THREE.LinearSRGBColorSpace;
        this.three.setPixelRatio(1);
        const gl = this.three.getContext();
        if (!gl.getExtension("EXT_color_buffer_float"))
            throw new Error("this device cannot draw into textures of floats (EXT_color_buffer_float)");
        this.camera = new THREE.Camera();
        this.whole = whole_geometry();
        const target = (type, depthBuffer) =>
            new THREE.WebGLRenderTarget(1, 1, {
                type, depthBuffer, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter,
            });
        this.point = target(THREE.HalfFloatType, true);
        this.sum = target(THREE.HalfFloatType, false);
        this.vertex_values = target(THREE.FloatType, false);
        this.texels = target(THREE.HalfFloatType, false);
        this.uniforms = {};
        this.turn = 0;  // of the groups of texels
    }

    /** Textures and programs. `advance`: called so many times as `steps()` says. */
    async load(advance) {
        const { page, uniforms } = this;
        const value = (name, to) => (uniforms[name] = { value: to });
        for (const [place, set] of Object.entries(page.sets))
            value(place === "surface" ? "texel_maps" : "view_maps", await layers_texture(this.three, set, advance));
        for (const table of page.model.tables) value(table.uniform, table_texture(await floats_of(table.entries)));
        value("map_scale", page.maps.map((m) => new THREE.Vector4(...m.scale, m.low)));
        value("map_offset", page.maps.map((m) => new THREE.Vector4(...m.offset, m.high)));
        value("term", page.model.terms.map(() => 1));
        for (const [name, numbers] of Object.entries(page.model.uniforms))
            value(name, numbers.length === 1 ? numbers[0] : new THREE.Vector3(...numbers));
        for (const [name, number] of Object.entries(page.model.whole_uniforms)) value(name, number);
        for (const name of ["eye", "lamp", "image_to_target"]) value(name, new THREE.Vector4());
        value("intensity", new THREE.Vector3(1, 1, 1));
        for (const name of ["lamp_seen", "lamp_inside", "camera_seen", "camera_inside"]) value(name, new THREE.Vector3(0, 0, 1));
        value("target_size", new THREE.Vector2());
        value("clip_from_world", new THREE.Matrix4());
        value("enhancement", new THREE.Vector3(1, 0, 1));
        value("share", 1);
        value("bounded", 1);
        value("shown", 0);
        value("most_shown", 1);
        value("texels", this.texels.texture);
        value("texel_step", 0);
        value("groups", 0);
        value("group", 0);
        value("atlas_size", new THREE.Vector2(page.sets.surface.width, page.sets.surface.height));

        const { grid, mesh } = page.surface;
        if (grid) {
            for (const key of ["origin", "right", "down", "normal"]) value(`grid_${key}`, new THREE.Vector3(...grid[key]));
            this.texel_scene = scene_of(this.whole, this.pass("whole", "texel", {}));
            this.surface = scene_of(this.whole, this.pass("whole", "pixel", {}));
        } else {
            const tables = await mesh_tables(mesh);
            value("vertices", tables.vertices);
            value("triangles", tables.triangles);
            value("vertex_count", tables.vertex_count);
            value("vertex_values", this.vertex_values.texture);
            value("largest_side", mesh.largest_side);
            value("rectangles_per_row", mesh.rectangles_per_row);
            const geometry = new THREE.BufferGeometry();
            geometry.setAttribute("position", new THREE.BufferAttribute(tables.corners, 3));
            const depth = { depthTest: true, depthWrite: true, depthFunc: THREE.LessDepth, side: THREE.FrontSide };
            this.texel_scene = scene_of(geometry, this.pass("texels", "texel", { side: THREE.DoubleSide }));
            this.surface = scene_of(geometry, this.pass("mesh", "pixel", depth));
            if (page.shaders.vertices) {
                const entries = tables.vertex_count * page.model.vertex_entries;
                this.vertex_values.setSize(table_columns, Math.ceil(entries / table_columns));
                this.vertex_scene = scene_of(this.whole, this.pass("whole", "vertices", {}));
            }
        }
        const added = material_of(page.shaders.whole, page.shaders.add, { picture: { value: this.point.texture } }, {
            depthTest: false, depthWrite: false, transparent: true, blending: THREE.CustomBlending,
            blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
        });
        this.add_scene = scene_of(this.whole, added);
        this.presented = {
            sum: { value: this.sum.texture }, pictures: { value: 1 }, sum_scale: { value: new THREE.Vector2(1, 1) },
            exposure: { value: new THREE.Vector3(1, 1, 1) }, stored: { value: null },
            image_to_target: { value: new THREE.Vector4() }, stored_size: { value: new THREE.Vector2(1, 1) },
            area: { value: new THREE.Vector4() }, shown: { value: 0 }, divider: { value: 0 }, error_factor: { value: 4 },
        };
        const present = material_of(page.shaders.whole, page.shaders.present, this.presented, { depthTest: false, depthWrite: false });
        this.present_scene = scene_of(this.whole, present);
    }

    pass(vertex, fragment, more) {
        return material_of(this.page.shaders[vertex], this.page.shaders[fragment], this.uniforms,
            { depthTest: false, depthWrite: false, ...more });
    }

    set_size(width, height) {
        this.size = [width, height];
        this.set_output(1);
    }
    /** Pixels of the canvas for each of its size: the browser enlarges fewer. */
    set_output(share) {
        const [width, height] = this.size.map((pixels) => Math.max(1, Math.round(share * pixels)));
        const canvas = this.three.domElement;
        this.output = [width / this.size[0], height / this.size[1]];
        if (canvas.width !== width || canvas.height !== height) this.three.setSize(width, height, false);
    }

    /** What is to be shown: camera, lamp, terms. Counts as new whatever was drawn before. */
    set_scene({ pose, direction, camera, lamp, lamp_seen, lamp_inside, camera_seen, camera_inside, share, enhancement, terms, shown,
        most_shown }) {
        const u = this.uniforms;
        this.view = { pose, camera };
        u.eye.value = direction ? with_place(direction, false) : with_place(pose.eye, true);
        u.camera_seen.value.set(...camera_seen);
        u.camera_inside.value.set(...camera_inside);
        if (lamp) {
            u.lamp.value = with_place(lamp.place, lamp.near);
            u.intensity.value.set(...lamp.intensity);
            u.lamp_seen.value.set(...lamp_seen);
            u.lamp_inside.value.set(...lamp_inside);
        }
        u.share.value = share;
        u.enhancement.value.set(...enhancement);
        u.term.value = terms;
        u.bounded.value = terms.every((t) => t === 1) ? 1 : 0;
        u.shown.value = shown;
        u.most_shown.value = most_shown;
        const meaning = JSON.stringify([terms, shown, most_shown]);
        const told = JSON.stringify([u.eye.value, u.lamp.value, u.intensity.value, share, enhancement, meaning]);
        if (meaning !== this.meaning) this.all_texels = true;  // those that are hidden, too: they may be seen before their turn
        if (told !== this.told) this.texels_known = false;  // else the camera only turned, or the picture's frame moved
        this.meaning = meaning;
        this.told = told;
        this.pictures = 0;
    }

    /**
     * A point of every pixel more, at (dx, dy) pixels from the centre, for an area of so many pixels; drawn `quality` as fine. Of
     * texels whose colours are no longer right, of a mesh one of `groups` groups is drawn anew; of a grid every `step`-th of rows
     * and columns.
     */
    draw_point(frame, { quality, groups, step }, dx, dy) {
        const width = Math.max(1, Math.round(frame.width * quality)), height = Math.max(1, Math.round(frame.height * quality));
        if (this.point.width !== width || this.point.height !== height) {
            this.point.setSize(width, height);
            this.sum.setSize(width, height);
            this.pictures = 0;
        }
        const scale = frame.scale * quality;
        const x = (frame.left * width) / frame.width - dx, y = (frame.top * height) / frame.height - dy;
        this.uniforms.image_to_target.value.set(scale, 0, x, y);
        this.uniforms.target_size.value.set(width, height);
        if (!this.page.surface.grid) this.set_projection(scale, x, y, width, height);
        const { three, camera } = this;
        if (step !== this.uniforms.texel_step.value) {
            const { width: columns, height: rows } = this.page.sets.surface;
            this.texels.setSize(Math.ceil(columns / step), Math.ceil(rows / step));
            this.uniforms.texel_step.value = step;
            this.texels_known = false;
        }
        if (!this.texels_known) {
            if (this.vertex_scene) {
                three.setRenderTarget(this.vertex_values);
                three.render(this.vertex_scene, camera);
            }
            this.turn = (this.turn + 1) % groups;
            this.uniforms.groups.value = this.all_texels ? 0 : groups;
            this.uniforms.group.value = this.turn;
            three.setRenderTarget(this.texels);
            three.render(this.texel_scene, camera);
            this.texels_known = this.all_texels || groups === 1;
            this.all_texels = false;
        }
        three.setClearColor(0, 0);
        three.setRenderTarget(this.point);
        three.clear();
        three.render(this.surface, camera);
        three.setRenderTarget(this.sum);
        if (this.pictures === 0) three.clear();
        three.render(this.add_scene, camera);
        three.setRenderTarget(null);
        this.pictures += 1;
        this.quality = [width / frame.width, height / frame.height];
    }

    /** From world space to clip space: a photograph's pixel p is at scale p + (x, y) of the target. */
    set_projection(scale, x, y, width, height) {
        const { pose, camera } = this.view;
        const { centre, mesh } = this.page.surface;
        const depth = dot(add(centre, pose.eye, -1), pose.forward);
        const far = depth + 1.01 * mesh.radius, near = Math.max(depth - 1.01 * mesh.radius, 1e-3 * mesh.radius);
        const fx = (2 * scale * camera.fx) / width, cx = (2 * (scale * camera.cx + x)) / width - 1;
        const fy = (-2 * scale * camera.fy) / height, cy = 1 - (2 * (scale * camera.cy + y)) / height;
        const a = (far + near) / (far - near), b = (-2 * far * near) / (far - near);
        const projection = new THREE.Matrix4().set(fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, a, b, 0, 0, 1, 0);
        const { right, down, forward, eye } = pose;
        const world = new THREE.Matrix4().set(
            ...right, -dot(right, eye), ...down, -dot(down, eye), ...forward, -dot(forward, eye), 0, 0, 0, 1);
        this.uniforms.clip_from_world.value.copy(projection.multiply(world));
    }

    /** An area of the screen. shown: as in shaders/view/present.frag. */
    present(area, frame, { shown, exposure, stored, stored_size, divider }) {
        const p = this.presented;
        p.pictures.value = Math.max(1, this.pictures);
        const [sx, sy] = this.output;
        const [qx, qy] = this.quality ?? [1, 1];
        p.sum_scale.value.set(qx / sx, qy / sy);
        p.exposure.value.set(...exposure);
        p.stored.value = stored;
        p.stored_size.value.set(...stored_size);
        p.image_to_target.value.set(frame.scale * sx, 0, frame.left * sx, frame.top * sy);
        const x = Math.round(sx * area.x), y = Math.round(sy * area.y);
        const width = Math.round(sx * area.width), height = Math.round(sy * area.height);
        p.area.value.set(x, y, width, height);
        p.shown.value = stored ? shown : 0;
        p.divider.value = divider * sx;
        this.three.setViewport(x, y, width, height);
        this.three.setScissor(x, y, width, height);
        this.three.setScissorTest(true);
        this.three.render(this.present_scene, this.camera);
        this.three.setScissorTest(false);
    }
}
