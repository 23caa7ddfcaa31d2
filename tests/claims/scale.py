"""Rules of experiments/claims/scale.cpp."""
from collections import defaultdict
from statistics import median

from claims.anew import BOTH, ratio, slope
from claims.fixture import GPU, LLVMPIPE, ClaimsTest

SIZES = (1e5, 2e5, 4e5, 8e5, 1.6e6)
ENGINES = ("cpu", "fragment paper", "fragment combined", "compute gather", "compute scatter")


def noise(round_, spread):
    """Of one round: a factor around 1, both ways."""
    return 1 + spread * ((round_ * 5) % 9 - 4) / 4


def rows_of_times(part, size, sizes, power, *, spread=0.0, rounds=9, renderer=GPU, apart=0.0):
    """Seconds = size to the power; power and spread of all engines, or by engine. Of sweeps alone: to a power less by so much."""
    rows = []
    for engine in ENGINES:
        exponent = power[engine] if isinstance(power, dict) else power
        for r in range(rounds):
            rows += [{"part": part, "engine": engine, "what": "iteration", "side": 8, "images": i + 1, "texels": 1000, "samples": 1000,
                      "parameters": 10, size: n, "repetition": r, "seconds": 1e-9 * n ** (exponent * noise(r, spread)),
                      "sweep_seconds": "" if engine == "cpu" else 1e-10 * n ** ((exponent - apart) * noise(r, spread)),
                      "renderer": "cpu, 2 threads" if engine == "cpu" else renderer} for i, n in enumerate(sizes)]
    return rows


def distribution(ratio=1.05, spread=0.0, rounds=9, renderer=GPU, compute=1.02):
    rows = []
    for r in range(rounds):
        for engine, what, seconds in (("fragment paper", "iteration", ratio * noise(r, spread)),
                                      ("fragment paper", "iteration, samples kept", 1),
                                      ("compute gather", "iteration", compute * noise(r, spread)),
                                      ("compute gather", "iteration, samples kept", 1),
                                      ("compute scatter", "iteration", 1.01),
                                      ("compute scatter", "iteration, samples kept", 1),
                                      ("cpu", "iteration", 1), ("cpu", "distribution", 2)):
            rows.append({"part": "distribution", "engine": engine, "what": what, "side": 8, "images": 20, "texels": 1000,
                         "samples": 1000, "parameters": 10, "repetition": r, "seconds": seconds, "sweep_seconds": "",
                         "renderer": "cpu, 2 threads" if engine == "cpu" else renderer})
    return rows


def memory(power=1.0, excess=1.0, sides=(8, 12, 16, 24, 32), triangles=6094, layout=143.5e6):
    return [{"engine": "fragment", "storage": storage, "passes": passes, "side": side, "triangles": triangles, "vertices": 3049,
             "parameters": 100 * side**2, "planned_bytes": 8000 * (side**2) ** power,
             "opengl_bytes": 8000 * (side**2) ** power * excess, "allocated_bytes": 1,
             "process_bytes": "" if passes == "paper" else 9000 * side**2, "paper_layout_bytes": layout * (side / 8) ** 2}
            for passes in ("paper", "combined") for storage in ("fp32", "fp16") for side in sides]


def declared(operations=1.05, reads=1.02):
    """work.csv: of iterations with distribution, over those with samples kept."""
    return [{"part": "distribution", "engine": "fragment paper", "what": what, "optimizer": optimizer, "images": 289,
             "operations": 1000 * (operations if what == "iteration" else 1), "reads": 100 * (reads if what == "iteration" else 1)}
            for what in ("iteration", "iteration, samples kept") for optimizer in ("sd", "cg")]


class Scaling(ClaimsTest):
    def scaling(self, claim, time=None, work=None, **changed):
        tables = {"memory": memory(**changed), "time": time or distribution(), "work": work or declared()}
        return self.finding(claim, "scaling", tables)

    def test_distribution_in_every_sweep(self):
        row = self.scaling("C13", distribution(renderer=LLVMPIPE))
        self.assertEqual(row["verdict"], "holds", "counts")
        self.assertEqual([m["value"] for m in row["measures"]], [1.05, 1.05, 1.02, 1.02])
        more = self.scaling("C13", work=declared(operations=1.3))
        self.assertEqual((more["verdict"], more["readings"][0]["verdict"]), ("does not hold", "holds"), "of whole iterations")
        self.assertAlmostEqual(more["readings"][0]["measures"][0]["value"], 1 / (1 - 0.3 * (1 - 1 / 1.3)))
        self.assertIn("1.05 times the operations and 1.02 times the texture reads (SD)", row["sentence"])
        self.assertEqual(self.scaling("C13", work=declared(operations=1.2))["verdict"], "does not hold")
        self.assertEqual(self.scaling("C13", work=declared(reads=1.2))["verdict"], "does not hold")
        old = self.finding("C13", "scaling", {"memory": memory(), "time": distribution()})
        self.assertEqual(old["verdict"], "not comparable")
        self.assertIn("did not count", old["reason"])
        some = [{k: v for k, v in row.items() if k != "images"} for row in declared()]
        self.assertIn("of all images", self.scaling("C13", work=some)["reason"], "an older version's, of a few images")

    def test_the_time_of_distribution_decided_before(self):
        def former(**changed):
            return self.other(self.scaling("C13", distribution(**changed)))

        row = self.scaling("C13", distribution(spread=0.01))
        self.assertEqual(self.other(row), "holds")
        self.assertEqual(row["renderer"], GPU)
        self.assertAlmostEqual(row["former"][0]["measures"][0]["value"], 1.05)
        self.assertIn("on the CPU, 3 times", row["sentence"])
        self.assertEqual([m["of"].split(",")[1] for m in row["former"][0]["measures"]],
                         [" the paper's passes", " compute shaders that gather", " compute shaders that scatter"])
        self.assertEqual(former(ratio=1.2, spread=0.01), "does not hold")
        self.assertEqual(former(compute=3), "does not hold")
        self.assertEqual(former(ratio=1.1, spread=0.1), "undecided")
        self.assertEqual(former(rounds=8), "undecided")
        self.assertEqual(former(renderer=LLVMPIPE), "not comparable")

    def test_memory(self):
        row = self.scaling("C14")
        self.assertEqual((row["verdict"], self.other(row)), ("holds", "holds"))
        self.assertEqual((len(row["measures"]), len(row["former"][0]["measures"])), (5, 6))
        self.assertIn("143.5 MB for 6094 triangles", row["sentence"])
        self.assertTrue(any("resident memory grew by 1.12" in text for text in row["beside"]))
        self.assertEqual(self.scaling("C14", power=1.08)["verdict"], "does not hold")
        self.assertEqual(self.scaling("C14", power=0.8)["verdict"], "holds", "an upper bound")
        self.assertEqual(self.scaling("C14", excess=1.06)["verdict"], "does not hold")
        self.assertEqual(self.scaling("C14", excess=0.9)["verdict"], "holds")
        for layout in (151e6, 134e6):
            row = self.scaling("C14", layout=layout)
            self.assertEqual((row["verdict"], self.other(row)), ("holds", "does not hold"), "an accounting that was sought")
        row = self.scaling("C14", triangles=1280, layout=30e6)
        self.assertEqual((row["verdict"], self.other(row)), ("holds", "not comparable"), "of another mesh the paper states nothing")
        self.assertEqual(self.scaling("C14", sides=(12, 16, 24, 32))["verdict"], "not comparable")
        self.assertEqual(self.scaling("C14", sides=(8, 12, 16))["verdict"], "not comparable")

    def test_gather_and_scatter(self):
        def finding(gather, scatter, **changed):
            power = {**dict.fromkeys(ENGINES, gather), "compute scatter": scatter}
            return self.scaling("C15", rows_of_times("texels", "texels", SIZES, power, **changed))

        row = finding(0.9, 0.1, spread=0.02)
        self.assertEqual(row["verdict"], "holds")
        self.assertEqual([m["outcome"] for m in row["measures"]], ["holds"] * 3)
        self.assertAlmostEqual(row["measures"][0]["value"], 0.9)
        self.assertAlmostEqual(row["measures"][2]["value"], 0.1)
        self.assertIn("0.9 (", row["sentence"])
        self.assertIn("to the power 0.1 (", row["sentence"])
        self.assertRegex(row["sentence"], r"between the two largest sizes 0\.1; from the fewest to the most texels they take [-0-9.e]+ to [-0-9.e]+ s")
        row = finding(0.3, 0.1)
        self.assertEqual([m["outcome"] for m in row["measures"]], ["does not hold"] * 2 + ["holds"])
        self.assertEqual(finding(0.9, 0.4)["verdict"], "does not hold")
        self.assertEqual(finding(0.9, 0.2, spread=0.1)["verdict"], "undecided")
        self.assertEqual(finding(0.9, 0.1, rounds=8)["verdict"], "undecided")
        row = finding(1.0, 0.3, apart=0.25)  # whole iterations are judged; sweeps are another reading, and were the rule
        self.assertEqual(row["verdict"], "does not hold")
        for kind in ("readings", "former"):
            self.assertEqual(self.other(row, kind), "holds")
            self.assertAlmostEqual(row[kind][0]["measures"][0]["value"], 0.75)
            self.assertAlmostEqual(row[kind][0]["measures"][2]["value"], 0.05)
        sizes = [n**0.8 for n in SIZES]
        power = {**dict.fromkeys(ENGINES, 0.9), "compute scatter": 0.1}
        self.assertEqual(self.scaling("C15", rows_of_times("texels", "texels", sizes, power))["verdict"], "not comparable")
        old = [{k: v for k, v in r.items() if k != "sweep_seconds"} for r in rows_of_times("texels", "texels", SIZES, power)]
        self.assertEqual(self.scaling("C15", old)["verdict"], "not run")

    def test_cost(self):
        def finding(sizes=SIZES, power=1.0, spread=0.0, rounds=9, **changed):
            return self.scaling("C18", rows_of_times("samples", "samples", sizes, power, spread=spread, rounds=rounds), **changed)

        row = finding(spread=0.02)
        self.assertEqual((row["verdict"], self.other(row)), ("holds", "holds"))
        self.assertEqual((len(row["measures"]), len(row["former"][0]["measures"])), (7, 4))
        self.assertAlmostEqual(row["measures"][0]["value"], 0, places=6, msg="on the line")
        self.assertAlmostEqual(row["measures"][3]["value"], 1, places=1, msg="nothing but samples cost")
        self.assertAlmostEqual(row["former"][0]["measures"][0]["value"], 1)
        bent = finding(power=1.3)
        self.assertEqual((bent["verdict"], self.other(bent)), ("does not hold", "does not hold"))
        cheap = finding(power=0.5)
        self.assertEqual((cheap["verdict"], self.other(cheap)), ("does not hold", "holds"), "it could not fail by being no line")
        flat = finding(power=0.0)
        self.assertEqual((flat["verdict"], self.other(flat)), ("does not hold", "holds"), "no cost of samples at all")
        one = finding(power={**dict.fromkeys(ENGINES, 1.0), "fragment combined": 1.3})
        self.assertEqual((one["verdict"], self.other(one)), ("does not hold", "does not hold"))
        self.assertEqual(self.other(finding(power=1.08, spread=0.1)), "undecided")
        self.assertEqual(finding(rounds=8)["verdict"], "undecided")
        self.assertEqual(finding(SIZES[:4])["verdict"], "not comparable")
        self.assertEqual(finding([n**0.9 for n in SIZES])["verdict"], "not comparable", "less than a factor of 16")
        self.assertEqual(finding(sides=(8, 16, 32))["verdict"], "holds")
        self.assertEqual(self.scaling("C18", rows_of_times("samples", "samples", SIZES, 1.0), power=1.2)["verdict"],
                         "does not hold", "memory")

    def test_rows_of_another_version(self):
        row = self.finding("C18", "scaling", {"memory": memory(), "time": [{"engine": "cpu", "seconds": 1}]})
        self.assertEqual(row["verdict"], "not run")


# Values anew.


def memory_slopes(run):
    lines = defaultdict(list)
    for r in run.rows("memory"):
        lines[f"{r['passes']} passes, {r['storage']}"].append((float(r["parameters"]), float(r["opengl_bytes"])))
    return [slope(lines[name]) for name in sorted(lines)]


def held_over_planned(run):
    return max(float(r["opengl_bytes"]) / float(r["planned_bytes"]) for r in run.rows("memory"))


def layout(run):
    rows = run.rows("memory")
    if abs(float(rows[0]["triangles"]) / 6093 - 1) <= 0.01:
        yield float([r for r in rows if r["side"] == "8"][-1]["paper_layout_bytes"]) / 1e6


def time_slope(run, of, engine, column="seconds"):
    rounds = defaultdict(list)
    for r in run.rows("time", part=of, engine=engine, what="iteration"):
        rounds[r["repetition"]].append((float(r[of]), float(r.get(column, r["seconds"]))))
    return median(map(slope, rounds.values()))


def timed(run, part, *engines):  # those of the engines that the run has
    return [e for e in engines if run.rows("time", part=part, engine=e)]


def lines(run):
    for engine in ("cpu", "fragment paper", "fragment combined"):
        rounds = defaultdict(dict)
        for r in run.rows("time", part="samples", engine=engine, what="iteration"):
            rounds[r["repetition"]][float(r["samples"])] = float(r["seconds"])
        yield list(rounds.values())


def line(points):  # a and b of a + b x, by least squares of relative errors
    w = {x: 1 / y**2 for x, y in points.items()}
    one, x1, x2 = (sum(w[x] * x**k for x in points) for k in range(3))
    y1, xy = (sum(w[x] * x**k * y for x, y in points.items()) for k in range(2))
    b = (one * xy - x1 * y1) / (one * x2 - x1**2)
    return (y1 - b * x1) / one, b


def cost(run):
    for rounds in lines(run):
        points = {x: median(r[x] for r in rounds) for x in rounds[0]}
        a, b = line(points)
        yield max(abs(a + b * x - y) / y for x, y in points.items())
    for rounds in lines(run):
        yield median(line(r)[1] * max(r) / r[max(r)] for r in rounds)
    yield max(memory_slopes(run))


def redistribution(run, computing=1):
    for column in ("operations", "reads"):
        for o in BOTH:
            anew, kept = (float(run.rows("work", engine="fragment paper", what=what, optimizer=o)[0][column])
                          for what in ("iteration", "iteration, samples kept"))
            yield 1 / (1 - computing * (1 - kept / anew))


def of_engines(run, part, engines, column="seconds"):
    return [time_slope(run, part, e, column) for e in timed(run, part, *engines)]


GATHER_SCATTER = ("fragment paper", "fragment combined", "compute scatter")
SWEEPS = lambda run: of_engines(run, "texels", GATHER_SCATTER, "sweep_seconds")  # noqa: E731
VALUES = {
    "C13": (redistribution, lambda run: redistribution(run, 0.3), lambda run: (ratio(*(run.rounds("time", "seconds", part="distribution", engine=e, what=what)
                                                 for what in ("iteration", "iteration, samples kept")))
                                         for e in timed(run, "distribution", "fragment paper", "compute gather", "compute scatter"))),
    "C14": (lambda run: (held_over_planned(run), *memory_slopes(run)),
            lambda run: (held_over_planned(run), *memory_slopes(run), *layout(run))),
    "C15": (lambda run: of_engines(run, "texels", GATHER_SCATTER), SWEEPS, SWEEPS),
    "C18": (cost, lambda run: (*of_engines(run, "samples", ("cpu", "fragment paper", "fragment combined")), max(memory_slopes(run)))),
}
