// Draws the state: coarse while something moves, then point after point of every pixel until the picture is as `render`'s.
import { picture_texture } from "./textures.js";
import { pose_of } from "./vectors.js";

const fine = { quality: 1, groups: 1, step: 1 };  // as Renderer.draw_point() takes it
const levels = [[1, 1], [1, 4], [0.75, 8], [0.5, 8], [0.5, 16], [0.35, 16], [0.25, 16]];  // quality and groups while something moves
const moving_ms = 250;            // after the last change
const slow_ms = 30, fast_ms = 18;  // of a frame, on average while something moves: where it becomes coarser, or finer

/** The points of a pixel, the centre first. */
function points_of(n) {
    const points = [];
    for (let row = 0; row < n; ++row)
        for (let column = 0; column < n; ++column) points.push([(column + 0.5) / n - 0.5, (row + 0.5) / n - 0.5]);
    return points.sort((a, b) => Math.hypot(...a) - Math.hypot(...b));
}

export class Stage {
    /** `scene_of(state)`: what Renderer.set_scene() takes. */
    constructor(canvas, renderer, page, state, scene_of) {
        Object.assign(this, { canvas, renderer, page, state, scene_of });
        this.begun = false;       // there is something to draw with
        this.stored = new Map();  // textures by name, or the promise of one
        this.level = 0;           // of levels
        this.pace = fast_ms;      // of a frame, on average
        this.easy = 0;            // frames that were fast enough for a finer level
        this.frames = 0;
        this.changed_at = -Infinity;
        new ResizeObserver(() => this.resize()).observe(canvas);
        canvas.addEventListener("webglcontextrestored", () => location.reload());
        this.resize();
    }

    resize() {
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        const box = this.canvas.getBoundingClientRect();
        this.ratio = ratio;
        this.width = Math.max(1, Math.round(box.width * ratio));
        this.height = Math.max(1, Math.round(box.height * ratio));
        this.renderer.set_size(this.width, this.height);
        this.change(false);
    }

    /** Something is to be drawn anew. moving: and soon again. */
    change(moving = true) {
        this.dirty = true;
        this.moved = moving;
        if (moving) this.changed_at = performance.now();
        this.ask();
    }
    /** Only how areas of the screen are made of pictures. */
    rearrange() {
        this.arranged = false;
        this.ask();
    }
    ask() {
        if (!this.begun) return;
        this.canvas.dataset.state = "drawing";
        if (!this.asked) this.asked = requestAnimationFrame((now) => this.frame(now));
    }

    /** The renderer is loaded. `drawn()` follows the first picture that is whole. */
    begin(drawn) {
        this.begun = true;
        this.drawn = drawn;
        this.ask();
    }

    view() {
        return this.page.views[this.state.view];
    }

    /** Areas of the screen, in pixels from the lower left corner: of a stored picture, of the fit. */
    areas() {
        const { width, height } = this;
        const whole = { x: 0, y: 0, width, height };
        if (this.state.layout !== "beside") return [whole, whole];
        if (width >= height) {
            const half = Math.floor(width / 2) - 1;
            return [{ ...whole, width: half }, { ...whole, x: width - half, width: half }];
        }
        const half = Math.floor(height / 2) - 1;
        return [{ ...whole, y: height - half, height: half }, { ...whole, height: half }];
    }

    /** Where a photograph's pixels are in an area: scale, and the corner's place from the upper left. */
    frame_in(area) {
        const { camera } = this.view();
        const { zoom, pan } = this.state;
        const scale = zoom * Math.min(area.width / camera.width, area.height / camera.height);
        return {
            width: area.width, height: area.height, scale,
            left: (area.width - scale * camera.width) / 2 + pan[0] * scale,
            top: (area.height - scale * camera.height) / 2 + pan[1] * scale,
        };
    }

    texture_of(name) {
        const known = this.stored.get(name);
        if (known) return known.isTexture ? known : null;
        this.stored.set(name, picture_texture(name).then((texture) => {
            this.stored.set(name, texture);
            for (const [other, kept] of this.stored)  // the last few are enough
                if (this.stored.size > 8 && kept.isTexture && other !== name) kept.dispose(), this.stored.delete(other);
            this.rearrange();
        }));
        return null;
    }

    frame(now) {
        this.asked = 0;
        const moving = (this.dirty && this.moved) || now - this.changed_at < moving_ms;
        const [stored_area, fit_area] = this.areas();
        const frame = this.frame_in(fit_area);
        const exact = this.page.surface.grid && frame.scale >= 1;
        const points = points_of(exact ? 1 : Math.max(this.page.pixel_points, frame.scale < 0.9 ? 3 : 1));
        if (this.dirty) {
            if (moving && this.drawn_at) this.adapt(now - this.drawn_at);
            this.drawn_at = moving ? now : 0;
            this.renderer.set_scene(this.scene_of(this.state));
            this.dirty = false;
            this.coarse = moving;
            if (moving) this.renderer.draw_point(frame, this.coarseness(frame), 0, 0);
            else this.renderer.draw_point(frame, fine, ...points[0]);
            ++this.frames;
        } else if (this.coarse && !moving) {
            this.renderer.pictures = 0;
            this.coarse = false;
            this.drawn_at = 0;
            this.renderer.draw_point(frame, fine, ...points[0]);
        } else if (!this.coarse && this.renderer.pictures < points.length) {
            this.renderer.draw_point(frame, fine, ...points[this.renderer.pictures]);
        }
        this.present(stored_area, fit_area);
        const whole = !this.coarse && this.renderer.pictures >= points.length && !this.missing;
        if (whole) {
            this.canvas.dataset.state = "still";
            this.drawn_first ??= now;  // milliseconds since the page was opened
            this.drawn?.();
            this.drawn = null;
        } else if (!this.missing || this.coarse || this.renderer.pictures < points.length) this.ask();
    }

    /** While something moves; a grid as fine as the picture. */
    coarseness(frame) {
        const [quality, groups] = levels[this.level];
        const grid = Boolean(this.page.surface.grid);
        return { quality, groups: grid ? 1 : groups, step: grid ? Math.max(1, Math.floor(1 / (frame.scale * quality))) : 1 };
    }

    adapt(ms) {
        this.pace += 0.3 * (ms - this.pace);
        if (this.pace > slow_ms && this.level + 1 < levels.length) {
            ++this.level;
            this.pace = fast_ms;  // what the finer level took says nothing of this one
        }
        if (this.pace < fast_ms && this.level > 0 && ++this.easy > 30) --this.level, this.easy = 0;
        if (this.pace >= fast_ms) this.easy = 0;
    }

    present(stored_area, fit_area) {
        const { state, renderer } = this;
        renderer.set_output(this.coarse ? levels[this.level][0] : 1);
        const view = this.view();
        const compared = state.show !== "fit" || state.layout !== "alone";
        const name = state.show === "baseline" ? view.baseline : view.photograph;
        const stored = compared && !state.pose ? this.texture_of(name) : null;
        this.missing = compared && !state.pose && !stored;
        const what = {
            stored, stored_size: [view.camera.width, view.camera.height], divider: state.divider * this.width,
            exposure: state.lamp ? [1, 1, 1] : view.gain.map((g) => 1 / g), shown: 0,
        };
        const of_stored = state.show === "error" ? 2 : 1;
        renderer.three.setClearColor(0, 1);
        renderer.three.clear();
        if (state.layout === "beside") {
            const left = this.frame_in(stored_area);
            renderer.present(stored_area, left, { ...what, shown: of_stored });
            renderer.present(fit_area, this.frame_in(fit_area), what);
        } else {
            const shown = !compared ? 0 : state.layout === "wipe" ? 2 + of_stored : of_stored;
            renderer.present(fit_area, this.frame_in(fit_area), { ...what, shown });
        }
    }

    /** The pose that is shown. */
    pose() {
        return this.state.pose ?? pose_of(this.view().camera);
    }
}
