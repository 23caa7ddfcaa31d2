// What the page shows, and the same behind the address's #, so that a link leads back to it.
const numbers = (text) => text.split(",").map(Number).filter(Number.isFinite);
const short = (x) => String(Number(x.toPrecision(6)));

export const pictures = ["fit", "photograph", "baseline", "error"];
export const layouts = ["alone", "wipe", "beside"];
export const meanings = ["colour", "samples", "residual", "uncertainty"];

/** What can be told of places of this model's fit. */
export const meanings_of = (model) => meanings.filter((m) => m !== "uncertainty" || model.most_uncertainty > 0);

export function state_of(hash, { views, model }) {
    const terms = model.terms.length;
    const asked = new URLSearchParams(hash.replace(/^#/, ""));
    const state = {
        view: 0, pose: null, zoom: 1, pan: [0, 0],
        show: "fit", layout: "alone", divider: 0.5,
        lamp: null, raking: false, brightness: 1, intensity: null, enhance: 0,
        terms: Array(terms).fill(1), known: "colour", bare: asked.has("bare"),
    };
    const one_of = (key, choices) => {
        if (choices.includes(asked.get(key))) state[key] = asked.get(key);
    };
    one_of("show", pictures);
    one_of("layout", layouts);
    one_of("known", meanings_of(model));
    const view = Number(asked.get("view") ?? -1);
    state.view = Math.max(0, views.findIndex((v) => v.number === view));
    const lamp = numbers(asked.get("lamp") ?? "");
    if (lamp.length === 3 && lamp.some((x) => x !== 0)) state.lamp = lamp.map((x) => x / Math.hypot(...lamp));
    state.raking = state.lamp !== null && asked.has("raking");
    const enhance = Number(asked.get("enhance") ?? NaN);
    if (model.enhancement && enhance >= 0 && enhance <= 1) state.enhance = enhance;
    const intensity = Number(asked.get("intensity") ?? NaN);
    if (intensity > 0) state.intensity = intensity;
    const brightness = Number(asked.get("brightness") ?? NaN);
    if (brightness > 0) state.brightness = brightness;
    const switched = asked.get("terms") ?? "";
    if (switched.length === terms) state.terms = [...switched].map((c) => (c === "0" ? 0 : 1));
    const pose = numbers(asked.get("pose") ?? "");
    if (pose.length === 12)
        state.pose = { right: pose.slice(0, 3), down: pose.slice(3, 6), forward: pose.slice(6, 9), eye: pose.slice(9) };
    const frame = numbers(asked.get("frame") ?? "");
    if (frame.length === 3 && frame[0] > 0) [state.zoom, state.pan] = [frame[0], frame.slice(1)];
    const divider = Number(asked.get("divider") ?? NaN);
    if (divider >= 0 && divider <= 1) state.divider = divider;
    return state;
}

export function hash_of(state, views) {
    const out = new URLSearchParams({ view: views[state.view].number });
    if (state.show !== "fit") out.set("show", state.show);
    if (state.layout !== "alone") out.set("layout", state.layout);
    if (state.layout === "wipe") out.set("divider", short(state.divider));
    if (state.known !== "colour") out.set("known", state.known);
    if (state.lamp) out.set("lamp", state.lamp.map(short).join(","));
    if (state.raking) out.set("raking", "");
    if (state.enhance > 0) out.set("enhance", short(state.enhance));
    if (state.intensity) out.set("intensity", short(state.intensity));
    if (state.brightness !== 1) out.set("brightness", short(state.brightness));
    if (state.terms.includes(0)) out.set("terms", state.terms.join(""));
    if (state.pose) out.set("pose", ["right", "down", "forward", "eye"].flatMap((k) => state.pose[k]).map(short).join(","));
    if (state.zoom !== 1) out.set("frame", [state.zoom, ...state.pan].map(short).join(","));
    if (state.bare) out.set("bare", "");
    return "#" + out.toString().replace(/%2C/g, ",");
}
