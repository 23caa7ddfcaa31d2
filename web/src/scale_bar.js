// A bar of a round length, as long as it would be at the middle of the surface.
import { add, dot, length } from "./vectors.js";

const longest = 130;  // pixels of the page
const units = [[1e3, "km"], [1, "m"], [1e-2, "cm"], [1e-3, "mm"], [1e-6, "µm"]];

/** Pixels of the page for a unit of the surface's coordinates. */
function pixels_per_unit({ surface }, stage) {
    const frame = stage.frame_in(stage.areas()[1]);
    const scale = frame.scale / stage.ratio;
    if (surface.grid) return scale / length(surface.grid.right);
    const pose = stage.pose();
    return (scale * stage.view().camera.fx) / dot(add(surface.centre, pose.eye, -1), pose.forward);
}

/** Its length in pixels and in words; null where the page knows no scale, or the surface's middle is behind the camera. */
export function scale_bar(page, stage) {
    if (!page.unit_metres) return null;
    const per_metre = pixels_per_unit(page, stage) / page.unit_metres;
    if (!(per_metre > 0 && Number.isFinite(per_metre))) return null;
    const most = longest / per_metre, tens = 10 ** Math.floor(Math.log10(most));
    const metres = [5, 2, 1].map((n) => n * tens).find((m) => m <= most) ?? tens;
    const [size, unit] = units.find(([least]) => metres >= 0.999 * least) ?? units.at(-1);
    return { pixels: metres * per_metre, text: `${Number((metres / size).toPrecision(3))} ${unit}` };
}
