// The angle between a direction and the cone that others span, as geometry/direction_hull.h has it: by nonnegative least squares
// (Lawson and Hanson 1974), where never more than three directions carry weight.
import { add, cross, dot, length, scaled } from "./vectors.js";

const tiny = 1e-12;

/** Least-squares weights of up to three directions. */
function weights_of(used, direction) {
    const [a, b, c] = used;
    if (used.length === 1) return [dot(a, direction) / dot(a, a)];
    if (used.length === 2) {
        const aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), da = dot(a, direction), db = dot(b, direction);
        const d = aa * bb - ab * ab || tiny;
        return [(bb * da - ab * db) / d, (aa * db - ab * da) / d];
    }
    const volume = dot(a, cross(b, c)) || tiny;
    return [dot(direction, cross(b, c)), dot(direction, cross(c, a)), dot(direction, cross(a, b))].map((x) => x / volume);
}

function nearest_in_cone(others, direction) {
    let used = [], weights = [], at = [0, 0, 0];
    for (let round = 0; round < 3 * others.length + 10; ++round) {
        const rest = add(direction, at, -1);
        let best = -1, gain = tiny;
        others.forEach((other, i) => {
            const along = dot(other, rest);
            if (along > gain) [gain, best] = [along, i];
        });
        if (best < 0 || used.includes(best) || used.length === 3) break;
        used.push(best);
        weights.push(0);
        for (;;) {
            const wanted = weights_of(used.map((i) => others[i]), direction);
            let step = 1;
            wanted.forEach((to, i) => {
                if (to <= 0) step = Math.min(step, weights[i] / (weights[i] - to));
            });
            const whole = wanted.every((w) => w > 0);
            weights = weights.map((w, i) => (whole ? wanted[i] : w + step * (wanted[i] - w)));
            if (whole) break;
            const kept = used.map((_, i) => i).filter((i) => weights[i] > tiny);
            used = kept.map((i) => used[i]);
            weights = kept.map((i) => weights[i]);
            if (used.length === 0) break;
        }
        at = used.reduce((sum, i, k) => add(sum, scaled(others[i], weights[k])), [0, 0, 0]);
    }
    return at;
}

/** The direction of the cone nearest to this one, which is that itself inside. All of unit length. */
export function nearest_inside(others, direction) {
    if (others.length === 0 || angle_outside(others, direction) === 0) return direction;
    const at = nearest_in_cone(others, direction);
    if (length(at) > 0) return scaled(at, 1 / length(at));
    return others.reduce((best, other) => (dot(other, direction) > dot(best, direction) ? other : best));
}

/** Radians; 0 inside. All of unit length. */
export function angle_outside(others, direction) {
    if (others.length === 0) return 0;
    const at = nearest_in_cone(others, direction);
    const angle = Math.atan2(length(add(direction, at, -1)), length(at));
    return angle < 1e-6 ? 0 : angle;
}
