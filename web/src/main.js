// The page that radiafit publish writes: puts its parts together.
import { attach, attach_divider } from "./controls.js";
import { LampDisc } from "./lamp.js";
import { build, by_id, choose, picture_word, plain_words, show_terms, view_words } from "./panel.js";
import { Renderer } from "./renderer.js";
import { scale_bar } from "./scale_bar.js";
import {
    axes_of, from_disc, lamp_direction, lamp_of, on_disc, outside_of, raking_height, raking_place, scene_of, share_of, side_of,
} from "./scene.js";
import { Stage } from "./stage.js";
import { hash_of, state_of } from "./state.js";
import { dot, normalized, orbited } from "./vectors.js";

const page = window.radiafit_page;
const canvas = by_id("picture");
const flat = Boolean(page.surface.grid);

function fail(message) {
    by_id("loading").hidden = false;
    by_id("loading_text").textContent = message;
    by_id("loading_bar").hidden = true;
    canvas.dataset.state = "failed";
}

function main(renderer) {
    const state = state_of(location.hash, page);
    const stage = new Stage(canvas, renderer, page, state, (s) => scene_of(page, s));
    const up = normalized(page.surface.up);
    let remembered = 0;

    const axes = () => axes_of(page, stage.pose());
    const lamp_now = () => lamp_direction(page, lamp_of(page, state));

    /** After a change of what is drawn; moving: more will follow. */
    function changed(moving = true) {
        stage.change(moving);
        show();
    }
    function arranged() {
        stage.rearrange();
        show();
    }
    const lamp_place = () => on_disc(lamp_now(), axes());
    function set_lamp(place) {
        state.lamp = from_disc(state.raking ? raking_place(place) : place, axes());
        changed();
    }
    /** By so much to the right and up; a raking lamp goes around, clockwise. */
    function move_lamp(dx, dy) {
        const [x, y] = lamp_place();
        if (!state.raking) return set_lamp([x + dx, y + dy]);
        const around = Math.abs(dx) > Math.abs(dy) ? dx : dy;
        set_lamp(raking_place([x, y], -around));
    }
    /** Turns the camera: a raking lamp goes with it. */
    function with_camera(turn) {
        const place = state.raking && lamp_place();
        turn();
        if (place) state.lamp = from_disc(raking_place(place), axes());
    }
    function whole() {
        state.zoom = 1;
        state.pan = [0, 0];
    }

    const act = {
        turn(dx, dy) {
            const radians = Math.PI / Math.max(300, Math.min(canvas.clientWidth, canvas.clientHeight));
            if (!flat) {
                with_camera(() => (state.pose = orbited(stage.pose(), page.surface.centre, up, -dx * radians, dy * -radians)));
            } else if (page.model.takes_light) {
                return move_lamp(dx * radians, -dy * radians);
            } else return act.pan(dx, dy);
            changed();
        },
        pan(dx, dy) {
            const { scale } = stage.frame_in(stage.areas()[1]);
            state.pan = [state.pan[0] + (dx * stage.ratio) / scale, state.pan[1] + (dy * stage.ratio) / scale];
            changed();
        },
        zoom(factor, x, y) {
            const area = stage.areas()[1];
            const before = stage.frame_in(area);
            const at = [x * stage.ratio - area.x, y * stage.ratio - (stage.height - area.y - area.height)];
            const zoom = Math.min(40, Math.max(0.2, state.zoom * factor));
            const photo = [(at[0] - before.left) / before.scale, (at[1] - before.top) / before.scale];
            state.zoom = zoom;
            const after = stage.frame_in(area);
            state.pan = [0, 1].map((i) => state.pan[i] + (at[i] - [after.left, after.top][i]) / after.scale - photo[i]);
            changed();
        },
        fit() {
            whole();
            changed(false);
        },
        view(i) {
            with_camera(() => ([state.view, state.pose] = [i, null]));
            act.back();
        },
        step(by) {
            act.view((state.view + by + page.views.length) % page.views.length);
        },
        back() {
            with_camera(() => (state.pose = null));
            whole();
            changed(false);
        },
        show(value) {
            if (value !== "fit" && state.pose) state.pose = null, stage.change(false);
            state.show = value;
            if (value !== "fit" && state.lamp) act.own_lamp();
            if (value === "error") state.enhance = 0, stage.change(false);
            if (value === "fit" && state.layout !== "alone") state.layout = "alone", stage.change(false);
            arranged();
        },
        layout(value) {
            state.layout = value;
            if (value !== "alone" && state.show === "fit") act.show("photograph");
            stage.change(false);
            arranged();
        },
        known(value) {
            state.known = value;
            changed(false);
        },
        brightness(value) {
            state.brightness = value;
            changed();
        },
        enhance(value) {
            if (!page.model.enhancement) return;
            state.enhance = value;
            if (state.show === "error" || state.layout === "alone") act.show("fit");
            changed();
        },
        raking() {
            if (!page.model.takes_light) return;
            state.raking = !state.raking;
            if (state.raking) set_lamp(lamp_place());
            else arranged();
        },
        own_lamp() {
            state.lamp = null;
            state.raking = false;
            state.brightness = 1;
            changed(false);
        },
        term(i, on) {
            state.terms = state.terms.map((t, k) => (k === i ? on : t));
            changed(false);
        },
        terms(all) {
            state.terms = all;
            changed();
        },
    };

    const disc = new LampDisc(by_id("lamp"), set_lamp, ([x, y]) => move_lamp(0.05 * x, 0.05 * y));

    /** Brings words and controls up to date. */
    function show() {
        const view = page.views[state.view];
        document.body.classList.toggle("bare", state.bare);
        by_id("view").value = state.view;
        choose("show", state.show);
        choose("layout", state.layout);
        choose("known", state.known);
        show_terms(state.terms, page.model.terms);
        by_id("view_text").textContent = view_words(view, page.model);
        by_id("return").hidden = !state.pose;
        show_labels(view);
        show_lamp(view);
        show_status();
        show_known();
        show_scale();
        canvas.setAttribute("aria-label", `${page.title}: ${picture_word(state.show)}, ${view.name}`);
        clearTimeout(remembered);
        remembered = setTimeout(() => {
            try {
                history.replaceState(null, "", hash_of(state, page.views));
            } catch {
                // some browsers forbid it to files: then there is no link to this state
            }
        }, 300);
    }

    function show_labels(view) {
        const compared = state.show !== "fit" || state.layout !== "alone";
        const words = {
            photograph: `Photograph ${view.name}`, baseline: `Plain: ${plain_words(page.model)}`,
            error: "4 × |model − photograph|", fit: state.enhance > 0 ? "Model, with drawn highlights" : "Model",
        };
        const first = by_id("first_label"), second = by_id("second_label");
        first.hidden = !compared;
        first.textContent = words[state.show];
        second.hidden = state.layout === "alone";
        second.textContent = words.fit;
        const stacked = state.layout === "beside" && stage.height > stage.width;
        second.style.left = stacked ? "10px" : state.layout === "beside" ? "calc(50% + 10px)" : "auto";
        second.style.right = state.layout === "wipe" ? "10px" : "auto";
        second.style.top = stacked ? "calc(50% + 10px)" : "10px";
        const halves = state.layout !== "alone" && !stacked;
        for (const label of [first, second]) label.style.maxWidth = `calc(${halves ? 50 : 100}% - 20px)`;
        const divider = by_id("divider");
        divider.hidden = state.layout !== "wipe";
        divider.style.left = `${100 * state.divider}%`;
        divider.setAttribute("aria-valuenow", Math.round(100 * state.divider));
    }

    function show_scale() {
        const bar = scale_bar(page, stage);
        by_id("scale").hidden = !bar;
        if (!bar) return;
        by_id("scale_bar").style.width = `${bar.pixels}px`;
        by_id("scale_text").textContent = bar.text;
    }

    function show_lamp(view) {
        if (!page.model.takes_light) return;
        const here = axes(), direction = lamp_now();
        const height = Math.asin(Math.max(-1, Math.min(1, -dot(direction, here.forward)))) * (180 / Math.PI);
        const above = flat ? "plane" : "horizon";
        by_id("lamp_text").textContent = state.raking
            ? `Raking: ${raking_height}° above the ${above}, from the ${side_of(on_disc(direction, here))}.`
            : state.lamp
            ? `Moved: ${Math.round(height)}° above the ${above}, of the photographs' mean brightness.`
            : `As in ${view.name}: ${Math.round(height)}° above the ${above}.`;
        by_id("own_lamp").hidden = !state.lamp && state.brightness === 1;
        by_id("brightness").value = Math.log2(state.brightness);
        by_id("enhance").value = state.enhance;
        by_id("raking").setAttribute("aria-pressed", state.raking);
        const dots = page.directions.lamps.filter((d) => dot(d, here.forward) < 0).map((d) => on_disc(d, here));
        disc.draw(on_disc(direction, here), dots, height < 0);
    }

    function show_status() {
        const outside = outside_of(page, state);
        const far = Math.max(outside.camera, outside.lamp);
        const what = outside.lamp > outside.camera ? "lamp" : "camera";
        const share = page.model.takes_light ? share_of(page, outside) : 1;
        const left = page.model.fades ? `${Math.round(100 * share)} % of the model, the rest is matt` : `as from the nearest photographed ${what}`;
        const turned = what === "lamp" || "half_length" in page.model.uniforms;  // of a light basis
        const faded = share < 1 && (page.model.fades || turned) ? `; ${left}` : "";
        const words = [];
        if (far >= 1) words.push(`The ${what} is ${Math.round(far)}° beyond the photographs': guesswork${faded}.`);
        if (state.pose && state.show === "fit" && state.layout === "alone" && state.known === "colour" && far < 1)
            words.push("Between the photographs: in between.");
        if (state.enhance > 0 && state.known === "colour" && !(state.layout === "alone" && state.show !== "fit"))
            words.push("Highlights are drawn, not photographed.");
        if (state.unknown.length) words.push(`The address asks for what this page does not have: ${state.unknown.join(", ")}.`);
        by_id("status").textContent = words.join(" ");
    }

    function show_known() {
        const { model } = page;
        const shown = state.known !== "colour";
        by_id("legend").hidden = !shown && state.show !== "error";
        const meaning = {
            colour: { text: "" },
            samples: {
                text: "In how many pixels of photographs each place of the surface was seen: where few saw it, little is known.",
                title: "Coverage, pixels", most: Math.round(model.most_samples),
            },
            residual: {
                text: `By how much the model misses its own photographs at each place (root mean square, ${model.residual_unit}).`,
                title: "Misfit, RMS", most: model.most_residual.toPrecision(2),
            },
            uncertainty: {
                text: "By how much the photographs' noise moves the model's colour at each place (standard deviation, white = 1); at the end of the scale also where the colour does not follow from the photographs.",
                title: "Uncertainty", most: model.most_uncertainty.toPrecision(2),
            },
        }[state.known];
        by_id("known_text").textContent = meaning.text;
        const bar = by_id("legend_bar");
        const viridis = "linear-gradient(90deg,#440154,#414487,#2a788e,#22a884,#7ad151,#fde725)";
        if (shown) {
            by_id("legend_title").textContent = meaning.title;
            by_id("legend_low").textContent = "0";
            by_id("legend_high").textContent = meaning.most;
            bar.style.background = viridis;
        } else {
            by_id("legend_title").textContent = "|model − photograph|, sRGB";
            by_id("legend_low").textContent = "0";
            by_id("legend_high").textContent = "¼ of white";
            bar.style.background = "linear-gradient(90deg,#000,#fff)";
        }
        by_id("legend_unseen").hidden = !shown;
    }

    build(page, act);
    attach(canvas, act);
    attach_divider(by_id("divider"), by_id("stage"), () => state.divider, (share) => {
        state.divider = share;
        arranged();
    });
    const keys = {
        "[": () => act.step(-1), "]": () => act.step(1),
        f: () => act.show("fit"), p: () => act.show("photograph"), b: () => act.show("baseline"), e: () => act.show("error"),
        r: () => act.raking(), h: () => act.enhance(state.enhance > 0 ? 0 : 1),
        1: () => act.layout("alone"), w: () => act.layout("wipe"), s: () => act.layout("beside"),
    };
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select")) return;
        keys[event.key.toLowerCase()]?.();
    });
    window.addEventListener("hashchange", (event) => {
        // Not location.hash, which may be that of the state before again: show() remembers states some time later.
        Object.assign(state, state_of(new URL(event.newURL).hash, page));
        changed(false);
    });
    new ResizeObserver(show).observe(canvas);
    if (state.known !== "colour" || state.terms.includes(0)) by_id("advanced").open = true;
    show();
    window.radiafit_viewer = { act, state, stage };
    return stage;
}

/** After what the page says so far has come to the screen; of a page that is not seen, soon. */
const shown = () => new Promise((go) => {
    requestAnimationFrame(() => setTimeout(go));
    setTimeout(go, 300);
});

// What a device held is gone when it was reset, or taken away: the page begins anew as soon as there is one.
canvas.addEventListener("webglcontextlost", (event) => {
    event.preventDefault();
    fail("The graphics device was lost. The page loads again as soon as it is back.");
});
canvas.addEventListener("webglcontextrestored", () => location.reload());

async function start() {
    if (!document.createElement("canvas").getContext("webgl2"))
        return fail("This browser offers no WebGL 2, with which the page draws. Try a current Firefox, Chrome, Edge or Safari, with hardware acceleration switched on.");
    const steps = Object.values(page.sets).reduce((sum, set) => sum + set.layers.length, 1);
    let done = 0;
    const advance = () => (by_id("loading_bar").value = ++done / steps);
    try {
        const renderer = new Renderer(canvas, page);
        const stage = main(renderer);
        await shown();
        await renderer.load(advance);
        stage.begin(() => {
            document.body.classList.remove("loading");
            by_id("loading").hidden = true;
            by_id("first_picture").hidden = true;
        });
    } catch (error) {
        fail(error.message);
        throw error;
    }
}
start();
