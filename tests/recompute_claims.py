#!/usr/bin/env python3
"""Every value of the claims, computed anew from the rows alone; nothing is shared with the program that judges them.

    recompute_claims.py CLAIMS.json FOLDER...     the folders that the runs named in it lie below
"""
import csv
import gzip
import json
import math
import pathlib
import statistics
import sys
from collections import defaultdict

RIVALS = ("pca-published", "pca-refilled")


class Run:
    def __init__(self, folder):
        self.folder, self.config = folder, json.loads((folder / "run.json").read_text())["config"]

    def rows(self, name, **wanted):
        packed = self.folder / (name + ".csv.gz")
        with gzip.open(packed, "rt", encoding="utf-8") if packed.exists() else open(self.folder / (name + ".csv"), encoding="utf-8") as f:
            return [r for r in csv.DictReader(f) if all(r[k] == str(v) for k, v in wanted.items())]

    def rounds(self, name, value, **wanted):
        """By repetition; value: a column, or a function of the row."""
        return {r["repetition"]: value(r) if callable(value) else float(r[value]) for r in self.rows(name, **wanted)}


def each(a, b, of=lambda x, y: x / y):
    return statistics.median([of(a[k], b[k]) for k in a if k in b])


def slope(points):
    """Of a straight line by least squares through logarithms."""
    x, y = zip(*((math.log(a), math.log(b)) for a, b in points))
    return statistics.linear_regression(x, y).slope


def arrivals(run, above, below, comparable=False):
    """Ratios of iterations by dataset, bust first."""
    out = defaultdict(list)
    for r in run.rows("problems"):
        if float(r["lambda"]) == run.config["lambda"] and not (comparable and abs(float(r["varpro_penalty"])) > 1e-3):
            a, b = (float(r[s]) for s in (above, below))
            cap = run.config["cap"]
            out[r["dataset"]].append((cap if a < 0 else max(1, a)) / (cap if b < 0 else max(1, b)))
    return [out[name] for name in sorted(out)]


def c2(run):
    minima = [(float(r["cg_minimum"]), float(r["sd_minimum"])) for r in run.rows("ends")
              if float(r["cg_minimum_at_rest"]) and float(r["sd_minimum_at_rest"])]
    apart = [(cg, sd) for cg, sd in minima if max(cg, sd) > 1.01 * min(cg, sd)]
    return [len(apart) / max(1, len(minima)), sum(cg < sd for cg, sd in apart) / len(apart) if apart else None]


def c3(run):
    n, out = run.config["iterations"], []
    for optimizer in ("sd", "cg"):
        gl = run.rounds("repetitions", lambda r: float(r["total_s"]) + (n - float(r["iterations"])) * float(r["iteration_s"]),
                        method="OpenGL (paper passes)", optimizer=optimizer)
        for threads in sorted({int(r["threads"]) for r in run.rows("repetitions", method="two-step (full record)")}):
            cpu = [run.rounds("repetitions", "total_s", method=f"two-step ({record} record)", optimizer=optimizer,
                              iterations=n, threads=threads) for record in ("full", "compact")]
            out.append(each(min(cpu, key=lambda c: statistics.median(c.values())), gl))
    return out


def c4(run):
    rows = run.rows("repetitions", method="two-step (full record)")
    threads, shares = max(int(r["threads"]) for r in rows), defaultdict(list)
    for r in rows:
        if int(r["threads"]) == threads:
            shares[r["optimizer"], r["iterations"]].append(float(r["distribution_s"]) / float(r["total_s"]))
    return [max(map(statistics.median, shares.values()))]


def fig8(run, column, optimizer, method="OpenGL (paper passes)"):
    return run.rounds("iterations", column, method=method, optimizer=optimizer)


def c7(run):
    shares = [{k: v / fig8(run, "seconds", o)[k] for k, v in fig8(run, "switching_s", o).items()} for o in ("sd", "cg")]
    return [statistics.median(shares[0].values()), each(shares[1], shares[0], lambda a, b: a - b)]


def c12(run):
    one, out = "OpenGL (combined passes, image by image)", []
    for o in ("sd", "cg"):
        reads = [float(run.rows("work", method=m, optimizer=o)[0]["reads"]) for m in (one, "OpenGL (paper passes)")]
        out += [each(fig8(run, "switching_s", o, one), fig8(run, "switching_s", o)), reads[0] / reads[1]]
    return out


def streamed(run, problem, passes, source, optimizer, part=""):
    return run.rounds("iterations", lambda r: float(r[f"direction{part}_s"]) + (optimizer == "cg") * float(r[f"line{part}_s"]),
                      problem=problem, passes=passes, source=source)


def fig10(run, of):
    return [x for p in ("light field map", "Lafortune") for o in ("sd", "cg")
            for x in of(run.rows("work", problem=p, optimizer=o, passes="paper")[0], dict(problem=p, optimizer=o, passes="paper"))]


def c10(run):
    peaks = [run.rounds("peaks", "per_second", peak=name) for name in ("operations of fragments", "texture reads")]
    return fig10(run, lambda w, key: [each(run.rounds("iterations", "seconds", **key), peak, lambda s, rate: float(w[k]) / s / rate)
                                      for k, peak in zip(("operations", "reads"), peaks)])


def c20(run):
    return fig10(run, lambda w, key: [each(run.rounds("iterations", "penalties_s", **key), run.rounds("iterations", "seconds", **key)),
                                      (float(w["penalty_operations"]) + float(w["shared_operations"])) / float(w["operations"])])


def c23(run):
    out = []
    for o, switching in (("sd", 0.5), ("cg", 0.66)):
        w = {k: float(v) for k, v in run.rows("work", problem="light field map", optimizer=o, passes="paper")[0].items()
             if k in ("reads", "operations", "image_bytes", "switches")}
        computing = max(w["reads"] / 0.65e9, w["operations"] / 2.6e9 / 8)
        total = computing / (1 - 0.2 - switching)
        out += [computing, total, w["image_bytes"] / (0.2 * total) / 1e6, switching * total / w["switches"] * 1e6]
    return out


def memory_slopes(run):
    lines = defaultdict(dict)
    for r in run.rows("memory"):
        lines[f"{r['passes']} passes, {r['storage']}"][float(r["parameters"])] = float(r["opengl_bytes"])
    return [slope(lines[name].items()) for name in sorted(lines)]


def c14(run):
    rows = run.rows("memory")
    layout = [float(r["paper_layout_bytes"]) / 1e6 for r in rows if r["side"] == "8"]
    return [max(float(r["opengl_bytes"]) / float(r["planned_bytes"]) for r in rows), *memory_slopes(run),
            *(layout[-1:] if abs(float(rows[0]["triangles"]) / 6093 - 1) <= 0.01 else [])]


def time_slope(run, part, engine, size):
    rounds = defaultdict(list)
    for r in run.rows("time", part=part, engine=engine, what="iteration"):
        rounds[r["repetition"]].append((float(r[size]), float(r["seconds"])))
    return statistics.median(map(slope, rounds.values()))


def c16(run):
    settings = defaultdict(list)
    for r in run.rows("problems", optimizer="cg"):
        settings[r["rule"], float(r["levels"])].append([float(r[c]) for c in ("error_over_best", "arrived_at", "stopped_at")])
    values = {}
    for key, problems in settings.items():
        last = sorted(math.inf if a < 0 else a for _, a, _ in problems)[len(problems) // 2] - 1
        running = sum(s < 0 or s > last for _, _, s in problems) / len(problems)
        values[key] = [statistics.median(e for e, _, _ in problems), running]
    return values


def c17(run):
    out = []
    for row in run.rows("datasets"):
        histogram = [(int(r["samples"]), int(r["texels"])) for r in run.rows(row["dataset"] + "_samples_per_texel")]
        half, up_to = sum(t for _, t in histogram) / 2, 0
        for samples, texels in histogram:
            up_to += texels
            if up_to >= half:
                break
        out += [samples, float(row["shared_texels"])]
    return out


def differences(run, pairs):
    """Means over seeds of one figure less another's: ((method, weights), (method, weights), column)."""
    rows, out = [r for r in run.rows("errors", terms=1) if r["seed"]], []
    for dataset in dict.fromkeys(r["dataset"] for r in rows):
        for a, b, column in pairs:
            figure = [{r["seed"]: float(r[column]) for r in rows if (r["dataset"], r["method"], r["weights"]) == (dataset, *m)}
                      for m in (a, b)]
            out.append(statistics.mean(figure[0][s] - figure[1][s] for s in figure[0] if s in figure[1]))
    return out


HIGH, LOW = ("cg-high", "chosen"), ("cg-low", "chosen")
VALUES = {
    "C1": lambda run: [statistics.median(r) for r in arrivals(run, "sd", "cg_paper")],
    "C2": c2, "C3": c3, "C4": c4, "C7": c7, "C10": c10, "C12": c12, "C14": c14, "C17": c17, "C20": c20, "C23": c23,
    "C5": lambda run: [each(fig8(run, "streaming_s", o), fig8(run, "seconds", o)) for o in ("sd", "cg")],
    "C6": lambda run: [each(streamed(run, "Lafortune", "paper", "disk-cold", o, "_streaming"),
                            streamed(run, "Lafortune", "paper", "disk-cold", o)) for o in ("sd", "cg")],
    "C8": lambda run: differences(run, [pair for rival in RIVALS for pair in ((HIGH, (rival, ""), "train_psnr_db"),
                                                                             ((rival, ""), HIGH, "train_ape"))]),
    "C9": lambda run: differences(run, [(("cg-low-fp16", "chosen"), ("cg-low-brief", "chosen"), "train_psnr_db")]),
    "C11": lambda run: [each(streamed(run, p, passes, "memory", o), streamed(run, p, passes, "disk-cold", o))
                        for p in ("light field map", "Lafortune") for passes in ("paper", "combined") for o in ("sd", "cg")],
    "C13": lambda run: [each(*(run.rounds("time", "seconds", part="distribution", engine="fragment paper", what=what)
                               for what in ("iteration", "iteration, samples kept")))],
    "C18": lambda run: [*(time_slope(run, "samples", e, "samples") for e in ("cpu", "fragment paper", "fragment combined")),
                        max(memory_slopes(run))],
    "C19": lambda run: [statistics.median(r) for r in arrivals(run, "cg_paper", "varpro", comparable=True)],
    "C21": lambda run: differences(run, [(HIGH, LOW, "train_psnr_db")]),
    "C15": lambda run: [time_slope(run, "texels", e, "texels") for e in ("fragment paper", "fragment combined")],
}


def c22(run):
    ratios = arrivals(run, "sd", "cg_paper")
    quartiles = [statistics.quantiles(r, n=4, method="inclusive") for r in ratios]
    medians = sorted(q[1] for q in quartiles)
    return [q[2] / q[0] for q in quartiles] + [medians[-1] / medians[0]]


VALUES["C22"] = c22


def values_of(claim, run, told):
    if claim != "C16":
        return VALUES[claim](run)
    found = c16(run)  # the threshold that was chosen is in the measure's name: "residual below 0.5/255, ..."
    names = [of.split("/255")[0].rsplit(" below ", 1) for of in told]
    return [found[rule, float(levels)][i % 2] for i, (rule, levels) in enumerate(names)]


def main(claims, folders):
    compared = wrong = 0
    for c in json.loads(pathlib.Path(claims).read_text())["claims"]:
        if not c["run"] or not c["measures"]:
            continue
        (folder,) = [f / c["run"] for f in map(pathlib.Path, folders) if (f / c["run"]).exists()]
        told = {m["of"]: m["value"] for m in c["measures"]}
        mine = values_of(c["id"], Run(folder), list(told))
        for (of, value), own in zip(told.items(), mine, strict=True):
            compared += 1
            same = value is None if own is None else value is not None and math.isclose(value, own, rel_tol=1e-9, abs_tol=1e-12)
            if not same:
                wrong += 1
                print(f"{c['id']}, {c['profile']} profile, {of}: {value} there, {own} by the rows")
    print(f"{compared} values compared, {wrong} differ")
    return wrong > 0 or compared == 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
