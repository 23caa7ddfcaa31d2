// What two substances that decay give off together, and the background.
struct Terms { real time; };
struct Parameters { real first, first_life, second, second_life, background; };
struct Values { real counts; };

Values value(Parameters p, Terms t) {
    return Values(p.first * exp(-t.time / p.first_life) + p.second * exp(-t.time / p.second_life) + p.background);
}
