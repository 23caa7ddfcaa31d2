// The disc on which the lamp is moved: the hemisphere towards the viewer, with the photographs' lamps as dots.
export class LampDisc {
    /** `moved([x, y])`: as far right and up as the sine of the angle. `stepped([x, y])`: by keys, so many steps right and up. */
    constructor(canvas, moved, stepped) {
        this.canvas = canvas;
        const point = (event) => {
            const box = canvas.getBoundingClientRect();
            moved([(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height]);
        };
        canvas.addEventListener("pointerdown", (event) => {
            canvas.setPointerCapture(event.pointerId);
            point(event);
        });
        canvas.addEventListener("pointermove", (event) => {
            if (canvas.hasPointerCapture(event.pointerId)) point(event);
        });
        canvas.addEventListener("keydown", (event) => {
            const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
            if (!by) return;
            event.preventDefault();
            stepped(by);
        });
    }

    /** at, dots: places on the disc; behind: the lamp is behind the surface. */
    draw(at, dots, behind) {
        const c = this.canvas.getContext("2d"), side = this.canvas.width, r = side / 2 - 4;
        const style = getComputedStyle(this.canvas);
        const to_x = (x) => side / 2 + r * x, to_y = (y) => side / 2 - r * y;
        const circle = (x, y, radius) => {
            c.beginPath();
            c.arc(to_x(x), to_y(y), radius, 0, 2 * Math.PI);
        };
        c.clearRect(0, 0, side, side);
        circle(0, 0, r);
        const glow = c.createRadialGradient(to_x(at[0]), to_y(at[1]), 4, to_x(at[0]), to_y(at[1]), 1.6 * r);
        glow.addColorStop(0, "#fff6dd");
        glow.addColorStop(1, "#3b3a40");
        c.fillStyle = glow;
        c.fill();
        c.lineWidth = 2;
        c.strokeStyle = style.color;
        c.stroke();
        c.fillStyle = "rgb(20 60 110 / 55%)";
        for (const [x, y] of dots) {
            circle(x, y, 3.5);
            c.fill();
        }
        circle(...at, 11);
        c.fillStyle = behind ? "#8a8a8a" : "#ffd24a";
        c.fill();
        c.lineWidth = 3;
        c.strokeStyle = "#1c1b19";
        c.stroke();
    }
}
