// The page's words and controls.
import { layouts, meanings_of, pictures } from "./state.js";

export const by_id = (id) => document.getElementById(id);
export const decibels = (x) => (Number.isFinite(x) ? `${x.toFixed(2)} dB` : "no loss");

function element(name, properties = {}, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
}

/** A row of choices, of which one holds. */
function segments(id, choices, chosen) {
    for (const [value, text] of choices) {
        const input = element("input", { type: "radio", name: id, value });
        input.addEventListener("change", () => chosen(value));
        by_id(id).append(element("label", {}, input, text));
    }
}
export function choose(id, value) {
    for (const input of by_id(id).querySelectorAll("input")) input.checked = input.value === value;
}

const picture_words = { fit: "Model", photograph: "Photograph", baseline: "Plain", error: "Difference" };
const layout_words = { alone: "One picture", wipe: "Wipe", beside: "Side by side" };
const meaning_words = { colour: "Colour", samples: "Coverage", residual: "Misfit", uncertainty: "Uncertainty" };
const paired = (keys, words) => keys.map((key) => [key, words[key]]);
export const picture_word = (show) => picture_words[show];

/** What the plain pictures are, in words. */
export const plain_words = (model) => (model.takes_light ? "matt colours, without gloss" : "one colour at each place, from wherever it is seen");

// A pixel's typical difference, as a share of white: below 1/32 the model is close to the photographs, below 1/16 fair.
const close_dB = 30, fair_dB = 24;
export const closeness = (dB) => (!Number.isFinite(dB) || dB >= close_dB ? "close" : dB >= fair_dB ? "fair" : "rough");
const short_decibels = (dB) => (Number.isFinite(dB) ? `${(Math.floor(10 * dB) / 10).toFixed(1)} dB` : "no loss");
const told = (dB) => `${closeness(dB)} (${decibels(dB)})`;

// Parts of models by names that need no formula.
const term_words = [
    [/^(rho_d|albedo|diffuse)$/, "matt colour"], [/^rho_s$/, "gloss"], [/^mean$/, "mean colour"], [/^one$/, "constant"],
    [/^function (\d+)$/, "change with direction $1"], [/^term (\d+)$/, "layer $1"], [/^lobe (\d+)$/, "sheen $1"],
];
const term_word = (name) => term_words.reduce((text, [from, to]) => text.replace(from, to), name);

const many_terms = 6;

const short_length = 12;
/** A photograph's name without folders and ending, its middle left out where it is long. */
function short_name(name) {
    const stem = name.replace(/^.*\//, "").replace(/(.)\.[^.]*$/, "$1");
    if (stem.length <= short_length) return stem;
    return `${stem.slice(0, 4)}…${stem.slice(5 - short_length)}`;
}

/** What was photographed, and how true the model is to it. */
function tell(page) {
    const { scores, model } = page;
    const score = scores.shown_psnr, word = closeness(score);
    by_id("about").textContent = page.caption || page.about;
    by_id("terms_of_use").textContent = [page.credit, page.licence && `Licence: ${page.licence}`].filter(Boolean).join("\n");
    by_id("terms_of_use").hidden = !by_id("terms_of_use").textContent;
    by_id("score_word").textContent = word[0].toUpperCase() + word.slice(1);
    by_id("score_number").textContent = decibels(score);
    const one = scores.photographs === 1;
    const kept = scores.split === "held out" ? "that the model never saw" : "that the model was made from";
    const off = Number.isFinite(score) ? `${(100 * 10 ** (-score / 20)).toPrecision(2)} % of white` : "by nothing";
    by_id("score_text").textContent =
        `Beside ${scores.photographs} ${one ? "photograph" : "photographs"} ${kept}, a pixel's colour is off by ${off}.`;
    by_id("figures").textContent =
        `${page.caption ? `${page.about} ` : ""}Shown: ${model.description}. Close: ${close_dB} dB and more; fair: ${fair_dB} dB and ` +
        `more; rough: less. PSNR (peak signal-to-noise ratio; higher is better) of the page ${decibels(score)}, of the fit before it was ` +
        `stored here ${decibels(scores.psnr)}, of the plain picture (${model.baseline}) ${decibels(scores.baseline_psnr)}.`;
    by_id("source").textContent = page.source;
    by_id("made").textContent =
        `Made by radiafit publish. The model's maps are stored in ${(scores.map_bytes / 1e6).toFixed(1)} MB of WebP; pictures ` +
        `drawn from them differ from the fit's own by ${scores.fidelity === null ? "nothing" : `${scores.fidelity.toFixed(1)} dB PSNR`}. ` +
        `Drawn with three.js (MIT licence).`;
    by_id("loading_text").textContent = `Loading ${Math.max(0.1, scores.map_bytes / 1e6).toFixed(1)} MB…`;
}

export function view_words(view, model) {
    const kind = view.held_out ? "the model never saw it" : "the model was made from it";
    return `${view.name}: ${kind}. Model: ${told(view.psnr)}; plain, ${plain_words(model)}: ${told(view.baseline_psnr)}.`;
}

/** act: what the controls do. */
export function build(page, act) {
    const { model } = page;
    tell(page);
    const kinds = new Map([[true, "The model never saw"], [false, "The model was made from"]]);
    for (const [held_out, label] of kinds) {
        const options = page.views.flatMap((view, i) =>
            view.held_out === held_out ? [element("option", { value: i }, `${short_name(view.name)} · ${short_decibels(view.psnr)}, ${closeness(view.psnr)}`)] : []);
        if (options.length) by_id("view").append(element("optgroup", { label }, ...options));
    }
    by_id("view").addEventListener("change", (event) => act.view(Number(event.target.value)));
    by_id("previous").addEventListener("click", () => act.step(-1));
    by_id("next").addEventListener("click", () => act.step(1));
    by_id("return").addEventListener("click", () => act.back());
    segments("show", paired(pictures, picture_words), act.show);
    segments("layout", paired(layouts, layout_words), act.layout);
    segments("known", paired(meanings_of(model), meaning_words), act.known);
    by_id("brightness").addEventListener("input", (event) => act.brightness(2 ** Number(event.target.value)));
    by_id("enhance").addEventListener("input", (event) => act.enhance(Number(event.target.value)));
    by_id("raking").addEventListener("click", () => act.raking());
    by_id("own_lamp").addEventListener("click", () => act.own_lamp());
    by_id("lamp_section").hidden = !model.takes_light;
    build_terms(model.terms, act);
    build_help(page);
}

function build_terms(terms, act) {
    const place = by_id("terms");
    if (terms.length > many_terms) {
        const slider = element("input", { type: "range", id: "rank", min: 0, max: terms.length - 1, step: 1 });
        slider.addEventListener("input", () => act.terms(terms.map((_, i) => (i <= Number(slider.value) ? 1 : 0))));
        place.append(element("label", { className: "wide", htmlFor: "rank" }, element("span", { id: "rank_text" })), slider);
        slider.className = "wide";
        return;
    }
    terms.forEach((name, i) => {
        const box = element("input", { type: "checkbox" });
        box.addEventListener("change", () => act.term(i, box.checked ? 1 : 0));
        place.append(element("label", {}, box, term_word(name)));
    });
}

export function show_terms(terms, names) {
    const slider = by_id("rank");
    if (!slider) {
        by_id("terms").querySelectorAll("input").forEach((box, i) => (box.checked = terms[i] > 0));
        return;
    }
    const last = terms.lastIndexOf(1);
    slider.value = last;
    by_id("rank_text").textContent = `${term_word(names[0])} and ${last} of ${names.length - 1} changes with direction`;
}

function build_help(page) {
    const flat = Boolean(page.surface.grid);
    const rows = [
        ["Drag, arrow keys", flat ? "move the lamp" : "turn around the object"],
        ["Wheel, pinch, + −", "zoom"],
        ["Shift + drag, two fingers", "move the picture"],
        ["0, double click", "whole picture"],
        ["[ ]", "previous, next photograph"],
        ["F P B E", "model, photograph, plain, difference"],
        ["1 W S", "one picture, wipe, side by side"],
        ...(page.model.takes_light ? [["R H", "raking light, drawn highlights"]] : []),
    ];
    by_id("help").append(...rows.flatMap(([key, what]) => [element("dt", {}, key), element("dd", {}, what)]));
}
