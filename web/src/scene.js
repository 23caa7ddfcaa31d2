// From the state to what is drawn: camera, lamp, and how much of the fit may be trusted there.
import { angle_outside, nearest_inside } from "./cone.js";
import { meanings } from "./state.js";
import { add, dot, normalized, pose_of, scaled } from "./vectors.js";

const degrees = 180 / Math.PI;

/** Of a grid the camera is the photograph's; what turns is the lamp. */
export function axes_of(page, pose) {
    const { grid } = page.surface;
    return grid ? { right: normalized(grid.right), down: normalized(grid.down), forward: scaled(normalized(grid.normal), -1) } : pose;
}

export function lamp_of(page, state) {
    const own = page.views[state.view].light;
    if (!state.lamp) return own && { ...own, intensity: own.intensity.map((i) => i * state.brightness) };
    const intensity = state.intensity ? [1, 1, 1].map((i) => i * state.intensity) : page.directions.irradiance;
    return { near: false, place: state.lamp, intensity: intensity.map((i) => i * state.brightness) };
}

/** The unit direction to the lamp from the middle of the surface. */
export function lamp_direction(page, lamp) {
    return lamp.near ? normalized(add(lamp.place, page.surface.centre, -1)) : lamp.place;
}

/** The same to the camera. */
export function camera_direction(page, state) {
    const { camera } = page.views[state.view];
    return camera.direction ?? normalized(add((state.pose ?? pose_of(camera)).eye, page.surface.centre, -1));
}

/** How far camera and lamp are, in degrees, from the directions of the photographs that were fitted. */
export function outside_of(page, state) {
    const { directions } = page;
    const lamp = page.model.takes_light ? lamp_of(page, state) : null;
    return {
        camera: degrees * angle_outside(directions.cameras, camera_direction(page, state)),
        lamp: lamp ? degrees * angle_outside(directions.lamps, lamp_direction(page, lamp)) : 0,
    };
}

/** eval/safe_relighting.h: share_of_fit(). */
export function share_of(page, outside) {
    const far = Math.max(outside.camera, outside.lamp) / degrees - page.directions.trusted;
    return Math.min(1, Math.max(0, 1 - Math.max(0, far) / page.directions.fade));
}

/** Of eval/specular_enhancement.h, `enhance` from 0 (off) to 1: shares of the colour and its luminance, the power. */
export function enhancement_of({ model }, { enhance }) {
    if (!model.enhancement) return [1, 0, 1];
    const { diffuse, highlight, exponent } = model.enhancement;
    return [1 + enhance * (diffuse - 1), enhance * highlight, exponent];
}

export function scene_of(page, state) {
    const view = page.views[state.view];
    const lamp = page.model.takes_light ? lamp_of(page, state) : null;
    const seen = lamp && lamp_direction(page, lamp), camera_seen = camera_direction(page, state);
    const shown = meanings.indexOf(state.known);
    return {
        pose: state.pose ?? pose_of(view.camera),
        direction: view.camera.direction,
        camera: view.camera,
        lamp,
        lamp_seen: seen,
        lamp_inside: seen && nearest_inside(page.directions.lamps, seen),
        camera_seen,
        camera_inside: nearest_inside(page.directions.cameras, camera_seen),
        share: page.model.takes_light ? share_of(page, outside_of(page, state)) : 1,
        enhancement: enhancement_of(page, state),
        terms: state.terms,
        shown,
        most_shown: [1, Math.log2(1 + page.model.most_samples), page.model.most_residual, page.model.most_uncertainty][shown],
    };
}

// Raking light: so low above the surface, where relief shows best.
export const raking_height = 15;  // degrees
const raking_radius = Math.cos(raking_height / degrees);

/** A place on the lamp's disc, moved to where the lamp rakes from the same side, and by an angle in radians around it; of a lamp
 *  straight above, from the upper left. */
export function raking_place([x, y], turned = 0) {
    const around = (Math.hypot(x, y) > 1e-3 ? Math.atan2(y, x) : (3 * Math.PI) / 4) + turned;
    return [raking_radius * Math.cos(around), raking_radius * Math.sin(around)];
}

/** Where a place on the disc is, in words. */
export function side_of([x, y]) {
    const sides = ["right", "upper right", "top", "upper left", "left", "lower left", "bottom", "lower right"];
    return sides[(Math.round((4 * Math.atan2(y, x)) / Math.PI) + 8) % 8];
}

/** A direction as the lamp's disc has it: x to the right, y up; its length is the sine of the angle to the viewer. */
export const on_disc = (direction, axes) => [dot(direction, axes.right), -dot(direction, axes.down)];
export function from_disc([x, y], axes) {
    const r = Math.hypot(x, y), most = 0.9998;
    if (r > most) [x, y] = [(x * most) / r, (y * most) / r];
    const z = Math.sqrt(1 - x * x - y * y);
    return add(add(scaled(axes.right, x), axes.down, -y), axes.forward, -z);
}
