// What the page shows, and the same behind the address's #, so that a link leads back to it.
const numbers = (text) => text.split(",").map(Number).filter(Number.isFinite);
const short = (x) => String(Number(x.toPrecision(6)));

export const pictures = ["fit", "photograph", "baseline", "error"];
export const layouts = ["alone", "wipe", "beside"];
export const meanings = ["colour", "samples", "residual", "uncertainty"];

/** What can be told of places of this model's fit. */
export const meanings_of = (model) => meanings.filter((m) => m !== "uncertainty" || model.most_uncertainty > 0);

/** `unknown`: what the address asks for and the page does not have, "key=value" each. */
export function state_of(hash, { views, model, first_view }) {
    const terms = model.terms.length;
    const asked = new URLSearchParams(hash.replace(/^#/, ""));
    const state = {
        view: first_view, pose: null, zoom: 1, pan: [0, 0],
        show: "fit", layout: "alone", divider: 0.5,
        lamp: null, raking: false, brightness: 1, intensity: null, enhance: 0,
        terms: Array(terms).fill(1), known: "colour", bare: asked.has("bare"), unknown: [],
    };
    // What a value says of the state, or null.
    const one_of = (key, choices) => (text) => (choices.includes(text) ? { [key]: text } : null);
    const number = (key, holds) => (text) => (text !== "" && holds(Number(text)) ? { [key]: Number(text) } : null);
    const list = (count, said) => (text) => {
        const values = numbers(text);
        return values.length === count ? said(values) : null;
    };
    const positive = (x) => x > 0 && x < Infinity, share = (x) => x >= 0 && x <= 1;
    const readers = {
        show: one_of("show", pictures), layout: one_of("layout", layouts), known: one_of("known", meanings_of(model)),
        view(text) {
            const view = views.findIndex((v) => String(v.number) === text);
            return view >= 0 ? { view } : null;
        },
        lamp: list(3, (v) => (model.takes_light && v.some((x) => x !== 0) ? { lamp: v.map((x) => x / Math.hypot(...v)) } : null)),
        enhance: number("enhance", (x) => model.enhancement && share(x)),
        intensity: number("intensity", positive),
        brightness: number("brightness", positive),
        terms: (text) => (text.length === terms && /^[01]*$/.test(text) ? { terms: [...text].map(Number) } : null),
        pose: list(12, (v) => ({ pose: { right: v.slice(0, 3), down: v.slice(3, 6), forward: v.slice(6, 9), eye: v.slice(9) } })),
        frame: list(3, (v) => (v[0] > 0 ? { zoom: v[0], pan: v.slice(1) } : null)),
        divider: number("divider", share),
        raking: () => ({}),
        bare: () => ({}),
    };
    for (const [key, text] of asked) {
        const said = Object.hasOwn(readers, key) ? readers[key](text) : null;
        if (said) Object.assign(state, said);
        else state.unknown.push(text ? `${key}=${text}` : key);
    }
    state.raking = state.lamp !== null && asked.has("raking");
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
