"""Rules of experiments/claims/scale.cpp."""
from collections import defaultdict
from statistics import median

from claims.anew import ratio, slope
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


class Scaling(ClaimsTest):
    def scaling(self, claim, time=None, **changed):
        return self.finding(claim, "scaling", {"memory": memory(**changed), "time": time or distribution()})

    def test_distribution_in_every_sweep(self):
        def finding(**changed):
            return self.scaling("C13", distribution(**changed))

        row = finding(spread=0.01)
        self.assertEqual(row["verdict"], "holds")
        self.assertEqual(row["renderer"], GPU)
        self.assertAlmostEqual(row["measures"][0]["value"], 1.05)
        self.assertIn("1.05", row["sentence"])
        self.assertIn("on the CPU, 3 times", row["sentence"])
        self.assertEqual([m["of"].split(",")[1] for m in row["measures"]],
                         [" the paper's passes", " compute shaders that gather", " compute shaders that scatter"])
        self.assertEqual(finding(ratio=1.2, spread=0.01)["verdict"], "does not hold")
        self.assertEqual(finding(compute=3)["verdict"], "does not hold")
        self.assertEqual(finding(ratio=1.1, spread=0.1)["verdict"], "undecided")
        self.assertEqual(finding(rounds=8)["verdict"], "undecided")
        self.assertEqual(finding(renderer=LLVMPIPE)["verdict"], "not comparable")

    def test_memory(self):
        row = self.scaling("C14")
        self.assertEqual(row["verdict"], "holds")
        self.assertEqual(len(row["measures"]), 6)
        self.assertIn("143.5 MB for 6094 triangles", row["sentence"])
        self.assertTrue(any("resident memory grew by 1.12" in text for text in row["beside"]))
        self.assertEqual(self.scaling("C14", power=1.08)["verdict"], "does not hold")
        self.assertEqual(self.scaling("C14", power=0.8)["verdict"], "holds", "an upper bound")
        self.assertEqual(self.scaling("C14", excess=1.06)["verdict"], "does not hold")
        self.assertEqual(self.scaling("C14", excess=0.9)["verdict"], "holds")
        self.assertEqual(self.scaling("C14", layout=151e6)["verdict"], "does not hold")
        self.assertEqual(self.scaling("C14", layout=134e6)["verdict"], "does not hold")
        row = self.scaling("C14", triangles=1280, layout=30e6)
        self.assertEqual(row["verdict"], "not comparable", "of another mesh the paper states nothing")
        self.assertEqual(len(row["measures"]), 5)
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
        row = finding(0.3, 0.1)
        self.assertEqual([m["outcome"] for m in row["measures"]], ["does not hold"] * 2 + ["holds"])
        self.assertEqual(finding(0.9, 0.4)["verdict"], "does not hold")
        self.assertEqual(finding(0.9, 0.2, spread=0.1)["verdict"], "undecided")
        self.assertEqual(finding(0.9, 0.1, rounds=8)["verdict"], "undecided")
        row = finding(1.0, 0.3, apart=0.25)  # sweeps are what is judged; whole iterations stand beside
        self.assertAlmostEqual(row["measures"][0]["value"], 0.75)
        self.assertAlmostEqual(row["measures"][2]["value"], 0.05)
        self.assertIn("are 1 (", row["beside"][0])
        sizes = [n**0.8 for n in SIZES]
        power = {**dict.fromkeys(ENGINES, 0.9), "compute scatter": 0.1}
        self.assertEqual(self.scaling("C15", rows_of_times("texels", "texels", sizes, power))["verdict"], "not comparable")
        old = [{k: v for k, v in r.items() if k != "sweep_seconds"} for r in rows_of_times("texels", "texels", SIZES, power)]
        self.assertEqual(self.scaling("C15", old)["verdict"], "not run")

    def test_cost(self):
        def finding(sizes=SIZES, power=1.0, spread=0.0, rounds=9, **changed):
            return self.scaling("C18", rows_of_times("samples", "samples", sizes, power, spread=spread, rounds=rounds), **changed)

        row = finding(spread=0.02)
        self.assertEqual(row["verdict"], "holds")
        self.assertEqual(len(row["measures"]), 4)
        self.assertAlmostEqual(row["measures"][0]["value"], 1)
        self.assertEqual(finding(power=0.3)["verdict"], "holds", "an upper bound can't be failed by being cheaper")
        self.assertEqual(finding(power=1.2, spread=0.02)["verdict"], "does not hold")
        self.assertEqual(finding(power={**dict.fromkeys(ENGINES, 1.0), "fragment combined": 1.2})["verdict"], "does not hold")
        self.assertEqual(finding(power=1.08, spread=0.1)["verdict"], "undecided")
        self.assertEqual(finding(rounds=8)["verdict"], "undecided")
        self.assertEqual(finding(SIZES[:4])["verdict"], "not comparable")
        self.assertEqual(finding([n**0.9 for n in SIZES])["verdict"], "not comparable", "less than a factor of 16")
        self.assertEqual(finding(sides=(8, 16, 32))["verdict"], "holds")
        self.assertEqual(self.scaling("C18", rows_of_times("samples", "samples", SIZES, 1.0), power=1.2)["verdict"],
                         "does not hold", "memory")

    def test_rows_of_another_version(self):
        row = self.finding("C18", "scaling", {"memory": memory(), "time": [{"engine": "cpu", "seconds": 1}]})
        self.assertEqual(row["verdict"], "not run")


class Samples(ClaimsTest):
    def verdict_of(self, median=26, facing=1500, shared=0, names=("star", "bust")):
        tables = {"datasets": [{"dataset": name, "sides": sides,
                                "shared_texels": shared if (name, sides) == ("bust", "own") else 1 - (sides == "own")}
                               for name in names for sides in ("one", "own")]}  # fmt: skip
        for name in names:
            for files, texels, middle in ((name, 500, 3), (name + "_own_sides", facing, median if name == "bust" else 30)):
                tables[files + "_images"] = [{"image": i, "covered_pixels": 1000, "kept_pixels": 700,
                                              "facing_texels": texels + i - 2} for i in range(5)]  # fmt: skip
                tables[files + "_samples_per_texel"] = [{"samples": n, "texels": count} for n, count in
                                                        ((0, 10), (9, 20), (middle, 300), (90, 50))]  # fmt: skip
        return self.finding("C17", "table1_datasets", tables)

    def test_pixels_and_texels(self):
        row = self.verdict_of()
        self.assertEqual(row["verdict"], "holds")
        self.assertIn("no texel takes two pixels", row["sentence"])
        self.assertIn("26 on the bust (1.50 texels per pixel)", row["sentence"])
        self.assertIn("star, sides by projected size: 1.5 texels per covered pixel in the median image, 30 samples in the "
                      "median texel; 30.0 % of the pixels are dropped, because no texel takes them; 2.6 % of the texels have "
                      "no sample, 7.9 % fewer than 10", row["beside"])  # fmt: skip
        self.assertIn("star, one side for all: 0.5 texels", " ".join(row["beside"]))
        self.assertEqual(self.verdict_of(median=8)["verdict"], "does not hold")
        self.assertEqual(self.verdict_of(shared=1)["verdict"], "does not hold")
        row = self.verdict_of(facing=900)
        self.assertEqual(row["verdict"], "not comparable")
        self.assertIn("bust has 0.9", row["reason"])
        self.assertEqual(self.verdict_of(names=("bust",))["verdict"], "not comparable")


# Values anew.


def memory_slopes(run):
    lines = defaultdict(list)
    for r in run.rows("memory"):
        lines[f"{r['passes']} passes, {r['storage']}"].append((float(r["parameters"]), float(r["opengl_bytes"])))
    return [slope(lines[name]) for name in sorted(lines)]


def memory_values(run):
    rows = run.rows("memory")
    yield from (max(float(r["opengl_bytes"]) / float(r["planned_bytes"]) for r in rows), *memory_slopes(run))
    if abs(float(rows[0]["triangles"]) / 6093 - 1) <= 0.01:
        yield float([r for r in rows if r["side"] == "8"][-1]["paper_layout_bytes"]) / 1e6


def time_slope(run, of, engine, column="seconds"):
    rounds = defaultdict(list)
    for r in run.rows("time", part=of, engine=engine, what="iteration"):
        rounds[r["repetition"]].append((float(r[of]), float(r.get(column, r["seconds"]))))
    return median(map(slope, rounds.values()))


def timed(run, part, *engines):  # those of the engines that the run has
    return [e for e in engines if run.rows("time", part=part, engine=e)]


def samples(run):
    for row in run.rows("datasets", sides="own"):
        texels = [int(r["texels"]) for r in run.rows(row["dataset"] + "_own_sides_samples_per_texel")]
        yield from (next(i for i in range(len(texels)) if sum(texels[: i + 1]) >= sum(texels) / 2), float(row["shared_texels"]))


VALUES = {
    "C13": lambda run: (ratio(*(run.rounds("time", "seconds", part="distribution", engine=e, what=what)
                                for what in ("iteration", "iteration, samples kept")))
                        for e in timed(run, "distribution", "fragment paper", "compute gather", "compute scatter")),
    "C14": memory_values,
    "C15": lambda run: (time_slope(run, "texels", e, "sweep_seconds")
                        for e in timed(run, "texels", "fragment paper", "fragment combined", "compute scatter")),
    "C17": samples,
    "C18": lambda run: (*(time_slope(run, "samples", e) for e in ("cpu", "fragment paper", "fragment combined")), max(memory_slopes(run))),
}
