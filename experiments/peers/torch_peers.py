#!/usr/bin/python3
"""PyTorch's Adam and L-BFGS against our own fits, on the problems that `radiafit export problems` writes: who predicts held-out
samples as well as a converged fit, and when. `make peers` runs it. See docs/results.md, peers.

    torch_peers.py [--profile smoke|standard|paper] [--config FILE] [--radiafit PROGRAM] [--output FOLDER] [--threads N]
    torch_peers.py --run FOLDER [--output FOLDER]      draws the figure of an earlier run again
"""
import argparse
import contextlib
import ctypes
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
try:
    import numpy
    import torch
except ImportError as missing:
    sys.exit(print(f"torch_peers.py: {missing}; install it: scripts/install-packages.sh peers", file=sys.stderr) or 2)

from light_field import LightField
from run_folder import RunFolder, draw

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
NAME = "peers"


class Refused(Exception):
    """The user's mistake, or a program's: one line, and an exit status."""

    def __init__(self, line, status=2):
        super().__init__(line)
        self.status = status


# ---- PyTorch


def keep_memory():
    """glibc gives large blocks back at once, and the kernel clears them when they are asked for again: five times the time of an
    evaluation here. mallopt() makes it keep them."""
    trim_threshold, mmap_threshold = -1, -3
    libc = ctypes.CDLL(None)
    for option, most in ((trim_threshold, 2**31 - 1), (mmap_threshold, 2**30)):
        libc.mallopt(option, most)


class Clock:
    """Seconds, but for those in which it is stopped."""

    def __init__(self):
        self.before, self.since = 0.0, time.perf_counter()

    def seconds(self):
        return self.before if self.since is None else self.before + time.perf_counter() - self.since

    @contextlib.contextmanager
    def stopped(self):
        self.before, self.since = self.seconds(), None
        yield
        self.since = time.perf_counter()


def adam(parameters, error, clock, rate):
    """Comes back after every step."""
    optimizer = torch.optim.Adam(parameters, lr=rate)
    while True:
        optimizer.zero_grad()
        error(*parameters).backward()
        optimizer.step()
        yield


def lbfgs(parameters, error, clock, history):
    """Comes back after every iteration: a line search and an update of the history."""
    optimizer = torch.optim.LBFGS(parameters, max_iter=1, max_eval=10**6, tolerance_grad=0, tolerance_change=0, history_size=history,
                                  line_search_fn="strong_wolfe")  # fmt: skip
    again = False  # each step() begins by evaluating where the one before ended: what it need not do is not timed

    def evaluate():
        nonlocal again
        optimizer.zero_grad()
        with clock.stopped() if again else contextlib.nullcontext():
            value = error(*parameters)
            value.backward()
        again = False
        return value

    while True:
        optimizer.step(evaluate)
        again = True
        yield


def descend(problem, method, steps, target=None):
    """Points of a descent from the start: after every step until the target is reached, or without one after the last alone."""
    parameters = [p.clone().requires_grad_() for p in problem.start]
    points, clock = [], Clock()
    for step, _ in enumerate(method(parameters, problem.error, clock), 1):
        if target is not None or step == steps:
            with clock.stopped():
                points.append(point(problem, [p.detach() for p in parameters], step, clock.seconds()))
        if step == steps or (target is not None and points[-1]["psnr_db"] >= target):
            return points


@torch.no_grad()
def point(problem, parameters, iterations, seconds):
    error = float(problem.error(*parameters))
    return {"iterations": iterations, "seconds": seconds, "psnr_db": problem.psnr(*parameters), "error": error}


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
        return point(problem, problem.read(parameters), iterations, seconds), times["distribution_s"]


# ---- the contest


class Contestant:
    """One solver of a setting: the points on its way to the target; then its times."""

    def __init__(self, name, library, run, curve, target):
        self.name, self.library, self.run, self.curve = name, library, run, curve
        self.reached = curve[-1]["psnr_db"] >= target
        self.iterations = curve[-1]["iterations"]
        self.times = []  # (point, setup in seconds) of each repetition


def torch_contestants(o, problem, setup, target):
    def contestant(name, method, most):
        curve = descend(problem, method, most, target)
        last = curve[-1]["iterations"]
        return Contestant(name, "PyTorch", lambda: (descend(problem, method, last)[-1], setup), curve, target)

    tried, most = [], o["adam_steps"]
    for rate in o["learning_rates"]:
        tried.append(contestant(f"Adam at {rate:g}", lambda *to, rate=rate: adam(*to, rate), most))
        most = tried[-1].iterations if tried[-1].reached else most
    best = min(tried, key=lambda c: (not c.reached, c.iterations if c.reached else -c.curve[-1]["psnr_db"]))
    return [best, contestant("L-BFGS", lambda *to: lbfgs(*to, o["history"]), o["lbfgs_iterations"])]


def our_contestants(o, ours, problem, setting, target):
    for name, solver in o["ours"].items():
        curve = []
        for iterations in o["iterations"]:
            curve.append(ours.fit(problem, setting, solver, iterations)[0])
            if curve[-1]["psnr_db"] >= target:
                break

        def again(solver=solver, iterations=curve[-1]["iterations"]):
            return ours.fit(problem, setting, solver, iterations)

        yield Contestant(name, "radiafit", again, curve, target)


def contest(o, ours, setting):
    """All contestants of a setting, timed by turns; the converged fit's PSNR and the one to reach."""
    begun = time.perf_counter()
    problem = LightField(ours.export(setting))
    setup = time.perf_counter() - begun
    converged = ours.fit(problem, setting, o["converged"])[0]["psnr_db"]
    target = converged - o["short_db"]
    all = [*torch_contestants(o, problem, setup, target), *our_contestants(o, ours, problem, setting, target)]
    for repetition in range(o["repetitions"]):
        for c in all[repetition % len(all) :] + all[: repetition % len(all)]:
            if c.reached or not c.times:  # who does not arrive is timed once
                c.times.append(c.run())
    return all, converged, target


def rows_of(setting, all, converged, target, renderer):
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
        ratios = [p["seconds"] / q["seconds"] for (p, _), (q, _) in zip(c.times, quickest.times)] if quickest else []
        figures = {"seconds": seconds, "times_ours": ratios, "setup_s": [s for _, s in c.times]}
        spread = {f"{name}{which}": number(of(values)) if values else "" for name, values in figures.items()
                  for which, of in (("", statistics.median), ("_least", min), ("_most", max))}  # fmt: skip
        summary.append({**who, "reached": int(c.reached), "iterations": c.iterations, "psnr_db": f"{c.times[-1][0]['psnr_db']:.4f}",
                        "target_db": f"{target:.4f}", "converged_db": f"{converged:.4f}", **spread,
                        "repetitions": len(c.times), "renderer": renderer})  # fmt: skip
    return curves, times, summary


def told(rows):
    for r in rows:
        said = f"{r['seconds']} s, {float(r['times_ours'] or 'nan'):.3g} times ours ({r['times_ours_least']} to {r['times_ours_most']})"
        how = f"{r['iterations']} iterations" if int(r["reached"]) else f"not reached in {r['iterations']} iterations"
        print(f"{r['setting']}: {r['library']} {r['solver']}: {said}; {how}, {r['psnr_db']} dB", file=sys.stderr)


# ---- the program


def read_config(path, profile):
    try:
        config = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise Refused(f"{path}: {error}; correct the file") from error
    known = set(tomllib.loads((HERE / "torch_peers.toml").read_text(encoding="utf-8")))
    changes = config.pop("profile", {}).get(profile, {})
    for key in (known - {"profile"}) ^ set(config) | set(changes) - known:
        raise Refused(f"{path}: '{key}' is {'missing' if key in known else 'no setting'}; compare torch_peers.toml")
    return {**config, **changes}


def dataset_folder(o, profile, radiafit):
    """That of the other experiments, made if it is not there."""
    folder = ROOT / "datasets/packed" / f"{o['dataset']}-{profile}"
    if not folder.exists():
        run([radiafit, "generate", o["dataset"], "--scale", profile, "-o", folder])
    return folder


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
        record["libraries"]["built"] |= {"python": sys.version.split()[0], "numpy": numpy.__version__, "torch": torch.__version__}
        results = RunFolder(given.output or ROOT / "results", NAME, record, sys.argv[1:])
        try:
            files = {"curves.csv": [], "times.csv": [], "peers.csv": []}
            for name, setting in o["settings"].items():
                for rows, more in zip(files.values(), rows_of(name, *contest(o, ours, setting), f"cpu, {threads} threads")):
                    rows += more
                told(files["peers.csv"][-2 - len(o["ours"]) :])
            for name, rows in files.items():
                results.write(name, rows)
            caption = (f"{o['dataset']} ({given.profile} scale), PyTorch {torch.__version__.split('+')[0]}; {results.device}; "
                       f"{datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d}")  # fmt: skip
            standard = given.config == HERE / "torch_peers.toml" and not given.output and not given.threads
            results.commit(config=o, profile=given.profile, standard=standard, seeds={"datasets": 1, "start": 1}, caption=caption)
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
    parser.add_argument("--config", type=pathlib.Path, default=HERE / "torch_peers.toml")
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
        print(f"torch_peers.py: {error}", file=sys.stderr)
        return error.status
    except OSError as error:
        print(f"torch_peers.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
