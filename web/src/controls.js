// Mouse, touch and keys on the picture. `act` has what they do: turn(dx, dy) in pixels, pan(dx, dy), zoom(factor, x, y), key(event).
export function attach(canvas, act) {
    const fingers = new Map();
    const place = (event) => {
        const box = canvas.getBoundingClientRect();
        return [event.clientX - box.left, event.clientY - box.top];
    };
    const middle = () => {
        const all = [...fingers.values()];
        return [0, 1].map((i) => all.reduce((sum, p) => sum + p[i], 0) / all.length);
    };
    const spread = () => {
        const [a, b] = [...fingers.values()];
        return Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
    };
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        fingers.set(event.pointerId, place(event));
    });
    canvas.addEventListener("pointermove", (event) => {
        if (!fingers.has(event.pointerId)) return;
        const before = middle(), apart = fingers.size === 2 ? spread() : 1;
        fingers.set(event.pointerId, place(event));
        const now = middle(), dx = now[0] - before[0], dy = now[1] - before[1];
        if (fingers.size === 2) act.zoom(spread() / apart, ...now);
        if (fingers.size === 2 || event.shiftKey || event.buttons & 6) act.pan(dx, dy);
        else if (fingers.size === 1) act.turn(dx, dy);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
        canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 16 : 1;
        act.zoom(Math.exp(-0.0015 * lines * event.deltaY), ...place(event));
    }, { passive: false });
    canvas.addEventListener("dblclick", () => act.fit());

    const step = 24, arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    canvas.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const arrow = arrows[event.key], centre = [canvas.clientWidth / 2, canvas.clientHeight / 2];
        if (arrow) (event.shiftKey ? act.pan : act.turn)(step * arrow[0], step * arrow[1]);
        else if (event.key === "+" || event.key === "=") act.zoom(1.15, ...centre);
        else if (event.key === "-") act.zoom(1 / 1.15, ...centre);
        else if (event.key === "0") act.fit();
        else return;
        event.preventDefault();
    });
}

/** A handle that is moved from side to side. `moved(share)`, `share()`. */
export function attach_divider(divider, parent, share, moved) {
    divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
    divider.addEventListener("pointermove", (event) => {
        if (!divider.hasPointerCapture(event.pointerId)) return;
        const box = parent.getBoundingClientRect();
        moved(Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
    });
    divider.addEventListener("keydown", (event) => {
        const by = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1, Home: -1, End: 1 }[event.key];
        if (!by) return;
        event.preventDefault();
        moved(Math.min(1, Math.max(0, share() + by)));
    });
}
