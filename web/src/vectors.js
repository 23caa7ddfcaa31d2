// Vectors of three numbers, and poses of cameras: unit vectors right, down and forward, and the eye's place, in world space.
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a, b, times = 1) => a.map((x, i) => x + times * b[i]);
export const scaled = (a, s) => a.map((x) => x * s);
export const length = (a) => Math.sqrt(dot(a, a));
export const normalized = (a) => scaled(a, 1 / (length(a) || 1));
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** `v` turned about a unit axis by an angle in radians (Rodrigues). */
export function turned(v, axis, angle) {
    const c = Math.cos(angle);
    return add(add(scaled(v, c), cross(axis, v), Math.sin(angle)), axis, (1 - c) * dot(axis, v));
}

/** Of a photograph's camera. */
export function pose_of(camera) {
    const r = camera.rotation;
    const [right, down, forward] = [r.slice(0, 3), r.slice(3, 6), r.slice(6, 9)];
    const t = camera.translation;
    const eye = [0, 1, 2].map((i) => -(right[i] * t[0] + down[i] * t[1] + forward[i] * t[2]));
    return { right, down, forward, eye };
}

/** The camera moved around `pivot`: about `up` by one angle, and about its own horizontal by another. */
export function orbited(pose, pivot, up, about_up, about_right) {
    const turn_up = (v) => turned(v, up, about_up);
    const right = normalized(turn_up(pose.right));
    const turn = (v) => turned(turn_up(v), right, about_right);
    const forward = normalized(turn(pose.forward));
    const down = normalized(cross(forward, right));
    return { right: cross(down, forward), down, forward, eye: add(pivot, turn(add(pose.eye, pivot, -1))) };
}
