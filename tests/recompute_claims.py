#!/usr/bin/env python3
"""Every value of the claims, computed anew from the rows alone; nothing is shared with the program that judges them.

    recompute_claims.py CLAIMS.json FOLDER...     the folders below which the runs lie that it names
"""
import csv
import gzip
import json
import math
import pathlib
import sys
from collections import defaultdict
from statistics import linear_regression, mean, median, quantiles

OPTIMIZERS, PAPER, ALONE = ("sd", "cg"), "OpenGL (paper passes)", "OpenGL (combined passes, image by image)"
PROBLEMS = ("light field map", "Lafortune")


class Run:
    def __init__(self, folder):
        self.folder, self.config = folder, json.loads((folder / "run.json").read_text())["config"]

    def rows(self, name, **wanted):
        path = self.folder / f"{name}.csv"
        with open(path, encoding="utf-8") if path.exists() else gzip.open(f"{path}.gz", "rt", encoding="utf-8") as file:
            return [r for r in csv.DictReader(file) if all(r[k] == str(v) for k, v in wanted.items())]

    def rounds(self, name, *columns, **wanted):  # sums of columns by repetition
        return {r["repetition"]: sum(float(r[c]) for c in columns) for r in self.rows(name, **wanted)}

    def part(self, column, optimizer, method=PAPER):
        return self.rounds("iterations", column, method=method, optimizer=optimizer)


def ratio(a, b):
    return median(a[k] / b[k] for k in a if k in b)


def slope(points):  # of a straight line by least squares through logarithms
    return linear_regression(*zip(*((math.log(x), math.log(y)) for x, y in points))).slope


def arrivals(run, above, below, comparable=False):  # ratios of iterations, dataset by dataset, the bust first
    out, cap = defaultdict(list), run.config["cap"]
    for r in run.rows("problems"):
        if float(r["lambda"]) == run.config["lambda"] and not (comparable and abs(float(r["varpro_penalty"])) > 1e-3):
            a, b = (cap if float(r[s]) < 0 else max(1, float(r[s])) for s in (above, below))
            out[r["dataset"]].append(a / b)
    return [out[name] for name in sorted(out)]


def minima(run):
    ends = [[float(r[f"{o}_minimum"]) for o in ("cg", "sd")] for r in run.rows("ends")
            if float(r["cg_minimum_at_rest"]) and float(r["sd_minimum_at_rest"])]
    apart = [(cg, sd) for cg, sd in ends if max(cg, sd) > 1.01 * min(cg, sd)]
    return len(apart) / max(1, len(ends)), sum(cg < sd for cg, sd in apart) / len(apart) if apart else None


def cpu_over_opengl(run):
    n = run.config["iterations"]
    for o in OPTIMIZERS:
        opengl = {r["repetition"]: float(r["total_s"]) + (n - float(r["iterations"])) * float(r["iteration_s"])
                  for r in run.rows("repetitions", method=PAPER, optimizer=o)}
        for threads in sorted({int(r["threads"]) for r in run.rows("repetitions", method="two-step (full record)")}):
            cpu = [run.rounds("repetitions", "total_s", method=f"two-step ({record} record)", optimizer=o, iterations=n,
                              threads=threads) for record in ("full", "compact")]
            yield ratio(min(cpu, key=lambda c: median(c.values())), opengl)


def distribution(run):
    shares, rows = defaultdict(list), run.rows("repetitions", method="two-step (full record)")
    for r in [r for r in rows if int(r["threads"]) == max(int(r["threads"]) for r in rows)]:
        shares[r["optimizer"], r["iterations"]].append(float(r["distribution_s"]) / float(r["total_s"]))
    return (max(map(median, shares.values())),)


def switching(run):
    sd, cg = ({k: v / run.part("seconds", o)[k] for k, v in run.part("switching_s", o).items()} for o in OPTIMIZERS)
    return median(sd.values()), median(cg[k] - sd[k] for k in cg if k in sd)


def combined(run):
    for o in OPTIMIZERS:
        reads = [float(run.rows("work", method=m, optimizer=o)[0]["reads"]) for m in (ALONE, PAPER)]
        yield from (ratio(run.part("switching_s", o, ALONE), run.part("switching_s", o)), reads[0] / reads[1])


def streamed(run, problem, passes, source, o, part=""):
    columns = [f"{half}{part}_s" for half in ("direction", "line")[: 1 + (o == "cg")]]
    return run.rounds("iterations", *columns, problem=problem, passes=passes, source=source)


def fig10(run, values):
    for problem in PROBLEMS:
        for o in OPTIMIZERS:
            key = {"problem": problem, "optimizer": o, "passes": "paper"}
            work = {k: float(v) for k, v in run.rows("work", **key)[0].items() if k not in key}
            yield from values(work, lambda column: run.rounds("iterations", column, **key))


def utilization(run):
    peaks = {c: run.rounds("peaks", "per_second", peak=p) for c, p in {"operations": "operations of fragments", "reads": "texture reads"}.items()}
    return fig10(run, lambda w, t: [median(w[c] / s / p[k] for k, s in t("seconds").items()) for c, p in peaks.items()])


def radeon(run):
    for o, switches in (("sd", 0.5), ("cg", 0.66)):
        w = {k: float(v) for k, v in run.rows("work", problem=PROBLEMS[0], optimizer=o, passes="paper")[0].items() if v[0].isdigit()}
        computing = max(w["reads"] / 0.65e9, w["operations"] / 2.6e9 / 8)
        total = computing / (1 - 0.2 - switches)
        yield from (computing, total, w["image_bytes"] / (0.2 * total) / 1e6, switches * total / w["switches"] * 1e6)


def memory_slopes(run):
    lines = defaultdict(list)
    for r in run.rows("memory"):
        lines[f"{r['passes']} passes, {r['storage']}"].append((float(r["parameters"]), float(r["opengl_bytes"])))
    return [slope(lines[name]) for name in sorted(lines)]


def memory(run):
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


def stopping(run, told):  # the thresholds that were chosen are in the measures' names: "residual below 0.5/255, ..."
    for i, of in enumerate(told):
        rule, levels = of.split("/255")[0].rsplit(" below ", 1)
        problems = [r for r in run.rows("problems", optimizer="cg", rule=rule) if float(r["levels"]) == float(levels)]
        arrived = sorted(math.inf if float(r["arrived_at"]) < 0 else float(r["arrived_at"]) for r in problems)
        last = arrived[len(arrived) // 2] - 1
        running = sum(float(r["stopped_at"]) < 0 or float(r["stopped_at"]) > last for r in problems) / len(problems)
        yield running if i % 2 else median(float(r["error_over_best"]) for r in problems)


def samples(run):
    for row in run.rows("datasets", sides="own"):
        texels = [int(r["texels"]) for r in run.rows(row["dataset"] + "_own_sides_samples_per_texel")]
        yield from (next(i for i in range(len(texels)) if sum(texels[: i + 1]) >= sum(texels) / 2), float(row["shared_texels"]))


def differences(run, *pairs):  # means over seeds of one method's figure less another's: (method, weights), (method, weights), column
    rows = [r for r in run.rows("errors", terms=1) if r["seed"]]
    for dataset in dict.fromkeys(r["dataset"] for r in rows):
        for *methods, column in pairs:
            a, b = ({r["seed"]: float(r[column]) for r in rows if (r["dataset"], r["method"], r["weights"]) == (dataset, *m)} for m in methods)
            yield mean(a[seed] - b[seed] for seed in a if seed in b)


HIGH, LOW, PSNR = ("cg-high", "chosen"), ("cg-low", "chosen"), "train_psnr_db"
RIVALS = (("pca-published", ""), ("pca-refilled", ""))
VALUES = {
    "C1": lambda run: map(median, arrivals(run, "sd", "cg_paper")), "C2": minima, "C3": cpu_over_opengl, "C4": distribution,
    "C5": lambda run: (ratio(run.part("streaming_s", o), run.part("seconds", o)) for o in OPTIMIZERS),
    "C6": lambda run: (ratio(*(streamed(run, "Lafortune", "paper", "disk-cold", o, p) for p in ("_streaming", ""))) for o in OPTIMIZERS),
    "C7": switching, "C10": utilization, "C12": combined, "C14": memory, "C17": samples, "C23": radeon,
    "C8": lambda run: differences(run, *(pair for r in RIVALS for pair in ((HIGH, r, PSNR), (r, HIGH, "train_ape")))),
    "C9": lambda run: differences(run, (("cg-low-fp16", "chosen"), ("cg-low-brief", "chosen"), PSNR)),
    "C11": lambda run: (ratio(*(streamed(run, problem, passes, source, o) for source in ("memory", "disk-cold")))
                        for problem in PROBLEMS for passes in ("paper", "combined") for o in OPTIMIZERS),
    "C13": lambda run: (ratio(*(run.rounds("time", "seconds", part="distribution", engine=e, what=what)
                                for what in ("iteration", "iteration, samples kept")))
                        for e in timed(run, "distribution", "fragment paper", "compute gather", "compute scatter")),
    "C15": lambda run: (time_slope(run, "texels", e, "sweep_seconds")
                        for e in timed(run, "texels", "fragment paper", "fragment combined", "compute scatter")),
    "C18": lambda run: (*(time_slope(run, "samples", e) for e in ("cpu", "fragment paper", "fragment combined")), max(memory_slopes(run))),
    "C19": lambda run: map(median, arrivals(run, "cg_paper", "varpro", comparable=True)),
    "C20": lambda run: fig10(run, lambda w, t: (ratio(t("penalties_s"), t("seconds")),
                                                (w["penalty_operations"] + w["shared_operations"]) / w["operations"])),
    "C21": lambda run: differences(run, (HIGH, LOW, PSNR)),
    "C22": lambda run: (lambda qs: [q[2] / q[0] for q in qs] + [max(q[1] for q in qs) / min(q[1] for q in qs)])(
        [quantiles(r, n=4, method="inclusive") for r in arrivals(run, "sd", "cg_paper")]),
}


def main(claims, *folders):
    compared, wrong = set(), 0
    for c in [c for c in json.loads(pathlib.Path(claims).read_text())["claims"] if c["run"] and c["measures"]]:
        (folder,) = [pathlib.Path(f, c["run"]) for f in folders if pathlib.Path(f, c["run"]).exists()]
        told = {m["of"]: m["value"] for m in c["measures"]}
        own = stopping(Run(folder), told) if c["id"] == "C16" else VALUES[c["id"]](Run(folder))
        for (of, value), mine in zip(told.items(), own, strict=True):
            compared.add((c["id"], c["profile"], of))
            if value != mine if value is None or mine is None else not math.isclose(value, mine, rel_tol=1e-9, abs_tol=1e-12):
                wrong += 1
                print(f"{c['id']}, {c['profile']} profile, {of}: {value} there, {mine} by the rows")
    print(f"{len(compared)} values of {len({c for c, _, _ in compared})} claims, {wrong} differ")
    return bool(wrong or not compared)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
