#!/usr/bin/python3
"""PyTorch's optimizers, a batched Levenberg-Marquardt by PyTorch, and SciPy's least_squares against our own fits, on the problems
that `radiafit export problems` writes: who predicts held-out samples as well as a converged fit, and when. `make peers` runs it.
See docs/results.md, peers.

    peers.py [--profile smoke|standard|paper] [--config FILE] [--radiafit PROGRAM] [--output FOLDER] [--threads N]
    peers.py --run FOLDER [--output FOLDER]      draws the figure of an earlier run again
"""
import argparse
import datetime
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib

# On a machine that others use, too, OpenMP's threads that wait for one another busily take many times their work.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
# Matrices are small: threads take batches of them, and SciPy has one.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
try:
    import numpy
    import scipy
    import torch

    import scipy_solvers
except ImportError as missing:
    sys.exit(print(f"peers.py: {missing}; install it: scripts/install-packages.sh peers", file=sys.stderr) or 2)

from batched_lm import batches, levenberg_marquardt
from light_field import LightField
from run_folder import RunFolder, draw
from torch_solvers import adam, descend, keep_memory, lbfgs, point

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
NAME = "peers"


class Refused(Exception):
    """The user's mistake, or a program's: one line, and an exit status."""

    def __init__(self, line, status=2):
        super().__init__(line)
        self.status = status


# ---- radiafit


def run(command):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode:
        raise Refused(done.stderr.strip().splitlines()[-1], done.returncode)


class Ours:
    def __init__(self, program, threads, dataset, folder):
        self.program, self.threads, self.dataset, self.folder = program, threads, dataset, pathlib.Path(folder)
        self.count = 0

    def run(self, *arguments):
        run([self.program, *map(str, arguments), "--threads", str(self.threads)])

    def new_name(self):
        self.count += 1
        return self.folder / str(self.count)

    def export(self, setting):
        problems = self.new_name()
        self.run("export", "problems", self.dataset, *shlex.split(setting), "-o", problems)
        return problems

    def fit(self, problem, setting, solver, iterations=None):
        """What a fit comes to: its point, and the seconds that reading images and distributing them took before."""
        fit, parameters = self.new_name(), self.new_name()
        most = [] if iterations is None else ["--iterations", iterations]
        self.run("fit", self.dataset, *shlex.split(setting), *shlex.split(solver), *most, "-o", fit)
        self.run("export", "parameters", fit, "-o", parameters)
        times = json.loads((fit / "fit.json").read_text())["times_s"]
        seconds = times["streaming_s"] + times["optimization_s"]
        return point(problem, problem.read(parameters), iterations, seconds), times["distribution_s"], parameters


# ---- the contest


class Contestant:
    """One solver of a setting: the points on its way to the target; then its times."""

    def __init__(self, library, name, run, curve, goal, **facts):
        """run: does it again: (point, setup in seconds). facts: columns of peers.csv that say what it solved, and how."""
        self.library, self.name, self.run, self.curve, self.goal, self.facts = library, name, run, curve, goal, facts
        self.reached = curve[-1]["psnr_db"] >= goal["target_db"]
        self.iterations = curve[-1]["iterations"]
        self.times = []  # (point, setup in seconds) of each repetition


def goal_of(psnr_db, short_db):
    """What a converged fit comes to, and what is to be reached."""
    return {"target_db": psnr_db - short_db, "converged_db": psnr_db}


def torch_contestants(o, problem, setup, goal, facts):
    def contestant(name, method, most, setup=setup, batch=facts["problems"]):
        curve = descend(problem, method, most, goal["target_db"], o["most_seconds"])
        last = curve[-1]["iterations"]
        print(f"PyTorch {name}: {curve[-1]['psnr_db']:.3f} of {goal['target_db']:.3f} dB after {last} iterations, {curve[-1]['seconds']:.1f} s",
              file=sys.stderr)  # fmt: skip
        return Contestant("PyTorch", name, lambda: (descend(problem, method, last)[-1], setup), curve, goal,
                          precision="32", batch=batch, **facts)  # fmt: skip

    tried, most = [], o["adam_steps"]
    for rate in o["learning_rates"]:
        tried.append(contestant(f"Adam at {rate:g}", lambda *to, rate=rate: adam(*to, rate), most))
        most = tried[-1].iterations if tried[-1].reached else most
    yield min(tried, key=lambda c: (not c.reached, c.iterations if c.reached else -c.curve[-1]["psnr_db"]))
    yield contestant("L-BFGS", lambda *to: lbfgs(*to, o["history"]), o["lbfgs_iterations"])
    begun = time.perf_counter()
    all = batches(problem, o["lm_vertices"])
    setup += time.perf_counter() - begun
    for name, project in (("LM", False), ("LM by projection", True)):
        yield contestant(name, lambda *to, project=project: levenberg_marquardt(*to, all, o["lm_damping"], project), o["lm_iterations"],
                         setup, 3 * max(len(batch.vertices) for batch in all))  # fmt: skip


def patches(o, problem):
    """Which triangles SciPy's problems are at the corners of [triangles]: those around vertices of drawn held-out samples."""
    a = problem.arrays
    corners, solved = a["triangle_vertices"], a["inverse_density"] > 0
    samples = numpy.diff(a["held_out_group_first"]).repeat(3)
    around = numpy.bincount(corners[a["held_out_group_triangle"]].reshape(-1), samples, len(solved))  # of each vertex
    around[corners[~solved[corners].all(1)]] = 0  # has a neighbour that is nobody's problem
    drawn = numpy.random.default_rng(o["scipy_seed"]).choice(len(solved), o["scipy_patches"], replace=False, p=around / around.sum())
    return numpy.isin(corners, drawn).any(1)


def scipy_contestants(o, problem, converged):
    """On few problems, by the held-out samples in the triangles that they are at all corners of; timed on the way, once. converged:
    maps."""
    a = problem.arrays
    triangles = patches(o, problem)
    samples = torch.from_numpy(triangles[a["held_out_group_triangle"]].repeat(numpy.diff(a["held_out_group_first"])))
    begun = time.perf_counter()
    each = [scipy_solvers.Problem(problem, v, c) for v in numpy.unique(a["triangle_vertices"][triangles]) for c in range(3)]
    setup = time.perf_counter() - begun
    goal = goal_of(problem.psnr(*converged, samples), o["scipy_short_db"])
    for name, how in o["scipy"].items():
        ways = [p.solve(**how) for p in each]
        maps, curve = [x.clone() for x in problem.start], []
        for step in range(1, max(map(len, ways))):
            reached = [way[min(step, len(way) - 1)] for way in ways]
            for p, (_, x) in zip(each, reached):
                p.unpack(x, *(map.numpy() for map in maps))
            error = sum(0.5 * float((p.residuals(x) ** 2).sum()) for p, (_, x) in zip(each, reached))
            curve.append({"iterations": step, "seconds": sum(seconds for seconds, _ in reached), "error": error,
                          "psnr_db": problem.psnr(*maps, samples)})  # fmt: skip
            if curve[-1]["psnr_db"] >= goal["target_db"]:
                break
        c = Contestant("SciPy", name, None, curve, goal, precision="64", batch=1, problems=len(each), renderer="cpu, 1 thread")
        c.times.append((curve[-1], setup))
        yield c


def our_contestants(o, ours, problem, setting, goal, facts):
    for name, solver in o["ours"].items():
        curve = []
        for iterations in o["iterations"]:
            curve.append(ours.fit(problem, setting, solver["options"], iterations)[0])
            if curve[-1]["psnr_db"] >= goal["target_db"]:
                break

        def again(solver=solver, iterations=curve[-1]["iterations"]):
            return ours.fit(problem, setting, solver["options"], iterations)[:2]

        yield Contestant("radiafit", name, again, curve, goal, precision=solver["precision"], batch=3, **facts)


def contest(o, ours, setting):
    """All contestants of a setting, timed by turns."""
    begun = time.perf_counter()
    problem = LightField(ours.export(setting))
    setup = time.perf_counter() - begun
    if problem.objective["printed_bounds"]:
        raise Refused(f"setting '{setting}': the paper's penalty of bounds is no sum of squares; leave --mode paper out")
    converged, _, parameters = ours.fit(problem, setting, o["converged"])
    goal = goal_of(converged["psnr_db"], o["short_db"])
    facts = {"problems": 3 * int((problem.arrays["inverse_density"] > 0).sum()), "renderer": f"cpu, {ours.threads} threads"}
    some = list(scipy_contestants(o, problem, problem.read(parameters)))
    all = [*torch_contestants(o, problem, setup, goal, facts), *our_contestants(o, ours, problem, setting, goal, facts)]
    for repetition in range(o["repetitions"]):
        for c in all[repetition % len(all) :] + all[: repetition % len(all)]:
            if c.reached or not c.times:  # who does not arrive is timed once
                c.times.append(c.run())
    return some + all


def rows_of(setting, all):
    """Rows of curves.csv, times.csv and peers.csv."""

    def median(c):
        return statistics.median(p["seconds"] for p, _ in c.times)

    def number(x):
        return f"{x:.6g}"

    first = [c for c in all if c.library == "radiafit" and c.reached]
    quickest = min(first, key=median) if first else None
    curves, times, summary = [], [], []
    for c in all:
        who = {"setting": setting, "library": c.library, "solver": c.name}
        curves += [{**who, "iteration": p["iterations"], "seconds": number(p["seconds"]), "psnr_db": f"{p['psnr_db']:.4f}",
                    "error": f"{p['error']:.6g}"} for p in c.curve]  # fmt: skip
        times += [{**who, "repetition": i, "iterations": p["iterations"], "seconds": number(p["seconds"]), "setup_s": number(s),
                   "psnr_db": f"{p['psnr_db']:.4f}"} for i, (p, s) in enumerate(c.times)]  # fmt: skip
        seconds = [p["seconds"] for p, _ in c.times]
        alike = quickest and c.facts["problems"] == quickest.facts["problems"]
        ratios = [p["seconds"] / q["seconds"] for (p, _), (q, _) in zip(c.times, quickest.times)] if alike else []
        figures = {"seconds": seconds, "times_ours": ratios, "setup_s": [s for _, s in c.times]}
        spread = {f"{name}{which}": number(of(values)) if values else "" for name, values in figures.items()
                  for which, of in (("", statistics.median), ("_least", min), ("_most", max))}  # fmt: skip
        summary.append({**who, "reached": int(c.reached), "iterations": c.iterations, "psnr_db": f"{c.times[-1][0]['psnr_db']:.4f}",
                        **{name: f"{db:.4f}" for name, db in c.goal.items()}, **spread, "repetitions": len(c.times),
                        **{name: c.facts[name] for name in ("renderer", "precision", "batch", "problems")}})  # fmt: skip
    return curves, times, summary


def told(rows):
    for r in rows:
        said = f"{r['seconds']} s, "
        if r["times_ours"]:
            said += f"{float(r['times_ours']):.3g} times ours ({r['times_ours_least']} to {r['times_ours_most']})"
        else:
            said += f"of {r['problems']} problems"
        how = f"{r['iterations']} iterations" if int(r["reached"]) else f"not reached in {r['iterations']} iterations"
        print(f"{r['setting']}: {r['library']} {r['solver']}: {said}; {how}, {r['psnr_db']} dB", file=sys.stderr)


# ---- the program


def read_config(path, profile):
    try:
        config = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise Refused(f"{path}: {error}; correct the file") from error
    known = set(tomllib.loads((HERE / "peers.toml").read_text(encoding="utf-8")))
    changes = config.pop("profile", {}).get(profile, {})
    for key in (known - {"profile"}) ^ set(config) | set(changes) - known:
        raise Refused(f"{path}: '{key}' is {'missing' if key in known else 'no setting'}; compare peers.toml")
    return {**config, **changes}


def dataset_folder(o, profile, radiafit):
    """That of the other experiments, made if it is not there."""
    folder = ROOT / "datasets/packed" / f"{o['dataset']}-{profile}"
    if not folder.exists():
        run([radiafit, "generate", o["dataset"], "--scale", profile, "-o", folder])
    return folder


def linear_algebra():
    """Files of the libraries that PyTorch's and SciPy's matrices are factored by: much of their time depends on which."""
    loaded = {pathlib.Path(line.split()[-1]).resolve().name for line in open("/proc/self/maps", encoding="utf-8") if ".so" in line}
    return ", ".join(sorted(name for name in loaded if any(word in name for word in ("blas", "lapack", "atlas", "mkl"))))


def measure(given):
    o = read_config(given.config, given.profile)
    threads = given.threads or len(os.sched_getaffinity(0))
    keep_memory()
    torch.set_num_threads(threads)
    dataset = dataset_folder(o, given.profile, given.radiafit)
    with tempfile.TemporaryDirectory(prefix="radiafit-peers-") as work:
        ours = Ours(given.radiafit, threads, dataset, work)
        probe = ours.export(next(iter(o["settings"].values())))
        record = json.loads((probe / "problems.json").read_text())["provenance"]
        versions = {"python": sys.version.split()[0], **{x.__name__: x.__version__ for x in (numpy, scipy, torch)}}
        record["libraries"]["built"] |= {**versions, "BLAS of torch": linear_algebra()}
        results = RunFolder(given.output or ROOT / "results", NAME, record, sys.argv[1:])
        try:
            files = {"curves.csv": [], "times.csv": [], "peers.csv": []}
            for name, setting in o["settings"].items():
                for rows, more in zip(files.values(), rows_of(name, contest(o, ours, setting))):
                    rows += more
                told([row for row in files["peers.csv"] if row["setting"] == name])
            for name, rows in files.items():
                results.write(name, rows)
            caption = (f"{o['dataset']} ({given.profile} scale), PyTorch {torch.__version__.split('+')[0]}, SciPy {scipy.__version__}; "
                       f"{results.device}; {datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d}")  # fmt: skip
            standard = given.config == HERE / "peers.toml" and not given.output and not given.threads
            seeds = {"datasets": 1, "start": 1, "scipy": o["scipy_seed"]}
            results.commit(config=o, profile=given.profile, standard=standard, seeds=seeds, caption=caption)
        finally:
            results.discard()
    figures = given.output or (ROOT / "paper_figs" if given.profile == "standard" else ROOT / "paper_figs" / given.profile)
    shown = draw(ROOT / f"paper_figs/{NAME}.gp", results.path, caption, figures if standard or given.output else results.path)
    for path in shown:
        print(f"figure: {path}", file=sys.stderr)
    print(f"rows: {results.path}", file=sys.stderr)


def draw_again(given):
    try:
        caption = json.loads((given.run / "run.json").read_text())["caption"]
    except (OSError, ValueError, KeyError) as error:
        raise Refused(f"{given.run}: no run of {NAME}: {error}") from error
    for path in draw(ROOT / f"paper_figs/{NAME}.gp", given.run, caption, given.output or pathlib.Path.cwd()):
        print(f"figure: {path}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--profile", default="standard", choices=("smoke", "standard", "paper"))
    parser.add_argument("--config", type=pathlib.Path, default=HERE / "peers.toml")
    parser.add_argument("--radiafit", type=pathlib.Path, default=ROOT / "build/release/bin/radiafit", help="the program")
    parser.add_argument("--output", type=pathlib.Path, help="folder for rows and figure, in place of the checkout's")
    parser.add_argument("--threads", type=int, default=0, help="of both; 0 is all cores")
    parser.add_argument("--run", type=pathlib.Path, help="only draw the figure of this earlier run")
    given = parser.parse_args()
    try:
        if not given.run and not given.radiafit.is_file():
            raise Refused(f"{given.radiafit}: no such program; run make build, or name it by --radiafit")
        draw_again(given) if given.run else measure(given)
    except Refused as error:
        print(f"peers.py: {error}", file=sys.stderr)
        return error.status
    except OSError as error:
        print(f"peers.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
