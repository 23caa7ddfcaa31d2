// A Gaussian peak on even ground, such as a molecule's spot in a microscope's image.
struct Terms { real x, y; };
struct Parameters { real height, x0, y0, width, ground; };
struct Values { real counts; };

Values value(Parameters p, Terms t) {
    real dx = t.x - p.x0, dy = t.y - p.y0;
    return Values(p.height * exp(-(dx * dx + dy * dy) / (2.0 * p.width * p.width)) + p.ground);
}
