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

const picture_words = { fit: "Fit", photograph: "Photograph", baseline: "Baseline", error: "Error" };
const layout_words = { alone: "One picture", wipe: "Wipe", beside: "Side by side" };
const meaning_words = { colour: "Colour", samples: "Samples", residual: "Misfit", uncertainty: "Uncertainty" };
const paired = (keys, words) => keys.map((key) => [key, words[key]]);
export const picture_word = (show) => picture_words[show];

const many_terms = 6;

/** act: what the controls do. */
export function build(page, act) {
    const { scores, model } = page;
    by_id("title").textContent = page.title;
    by_id("about").textContent = `${page.about} Shown: ${model.description}.`;
    by_id("score_number").textContent = scores.shown_psnr.toFixed(2);
    const unseen = scores.split === "held out" ? "photographs that the fit never saw" : "photographs that were fitted";
    by_id("score_text").textContent =
        `PSNR (peak signal-to-noise ratio; higher is better) against ${scores.photographs} ${unseen}. ` +
        `The fit before it was stored here: ${decibels(scores.psnr)}. Baseline, ${model.baseline}: ${decibels(scores.baseline_psnr)}.`;
    by_id("source").textContent = page.source;
    by_id("made").textContent =
        `Made by radiafit publish. The model's maps are stored in ${(scores.map_bytes / 1e6).toFixed(1)} MB of WebP; pictures ` +
        `drawn from them differ from the fit's own by ${scores.fidelity === null ? "nothing" : `${scores.fidelity.toFixed(1)} dB PSNR`}. ` +
        `Drawn with three.js (MIT licence).`;

    const kinds = new Map([[true, "Held out: never fitted"], [false, "Training: fitted"]]);
    for (const [held_out, label] of kinds) {
        const options = page.views.flatMap((view, i) =>
            view.held_out === held_out ? [element("option", { value: i }, `${view.name} · ${decibels(view.psnr)}`)] : []);
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
        place.append(element("label", {}, box, name));
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
    by_id("rank_text").textContent = `${names[0]} and ${last} of ${names.length - 1} functions`;
}

function build_help(page) {
    const flat = Boolean(page.surface.grid);
    const rows = [
        ["Drag, arrow keys", flat ? "move the lamp" : "turn around the object"],
        ["Wheel, pinch, + −", "zoom"],
        ["Shift + drag, two fingers", "move the picture"],
        ["0, double click", "whole picture"],
        ["[ ]", "previous, next photograph"],
        ["F P B E", "fit, photograph, baseline, error"],
        ["1 W S", "one picture, wipe, side by side"],
        ...(page.model.takes_light ? [["R H", "raking light, specular enhancement"]] : []),
    ];
    by_id("help").append(...rows.flatMap(([key, what]) => [element("dt", {}, key), element("dd", {}, what)]));
}
