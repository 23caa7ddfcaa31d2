#!/usr/bin/env python3
"""Whether two builds of radiafit fit the same bits: every solver, engine, storage and optimizer on the smoke datasets.

    same_bits.py BEFORE AFTER [TEXT...]

BEFORE and AFTER are programs. With TEXTs only the fits run whose command holds one of them. Compared are the maps, the
problems and the trace without its times. Exit status 1 if any fit differs."""
import itertools
import pathlib
import shutil
import subprocess
import sys
import tempfile

LIGHT_FIELD = [
    *(f"--optimizer {o} --mode {m} --terms {k}" for o, m, k in itertools.product(("cg", "sd"), ("paper", "modern"), (1, 3))),
    "--terms 3 --deflate",
    "--view nearest",
    "--space linear",
    "--lambda-surface 0 --lambda-view 0 --mu 0",
    "--stop-residual 0.02",
    "--stop-change 0.001",
    "--seed 5 --terms 2",
    "--optimizer lbfgs --terms 2",
    "--optimizer adam --terms 2",
]
STEPS = ["--solver two-step", "--solver two-step --record full", "--solver two-step --terms 2 --sort-memory 20K"]
OTHERS = [f"--solver {s} --terms {k}" for s, k in itertools.product(("pca", "ceres", "als", "varpro"), (1, 2))] + ["--solver mean"]
FRAGMENT = [f"--engine fragment --passes {p} --storage {s} --sums {t} --optimizer {o}" for p, s, t, o in itertools.product(
    ("paper", "combined"), ("fp32", "fp16", "fp16-truncate"), ("fp32", "fp16"), ("cg", "sd"))]  # fmt: skip
FRAGMENT += [f"--engine fragment --terms 2 --optimizer {o}" for o in ("lbfgs", "adam")]
COMPUTE = [f"--engine compute --samples {s} --accumulate {a} --terms {k} --optimizer {o}" for s, a, k, o in itertools.product(
    ("cached", "redistributed"), ("gather", "scatter-fixed"), (1, 3), ("cg", "lbfgs"))]  # fmt: skip
MODES = [f"--optimizer {o} --mode {m}" for o, m in itertools.product(("cg", "sd"), ("paper", "modern"))]
TEXELS = [f"--model {model} {more}" for model in ("lafortune", "lambert", "ptm") for more in (
    "--optimizer lm", *MODES, *(f"--solver two-step {m}" for m in ("--optimizer lm", *MODES)), "--solver ceres",
    "--engine fragment --passes paper --optimizer cg", "--engine fragment --passes combined --optimizer cg",
    "--engine fragment --passes combined --optimizer cg --storage fp16 --mode paper",
    "--engine fragment --passes combined --optimizer sd", "--engine compute --optimizer cg",
    "--engine compute --optimizer lbfgs --mode modern", "--clip-above 0.9 --shadow-below 0.1 --optimizer cg")]  # fmt: skip
FITS = [("star", f"{options} --iterations 8") for options in (*LIGHT_FIELD, *STEPS, *FRAGMENT, *COMPUTE)]
FITS += [("star", options if "pca" in options or "mean" in options else f"{options} --iterations 4") for options in OTHERS]
FITS += [("ornament", f"{options} --iterations 6") for options in TEXELS]


def run(program, *arguments):
    result = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{program} {' '.join(arguments)}: {result.stderr.strip()}")


def untimed(trace):
    rows = [line.split(",") for line in trace.read_text().splitlines()]
    at = rows[0].index("time_s")
    return [row[:at] + row[at + 1 :] for row in rows]


def differing(a, b):
    """Names of what differs between two fits' folders."""
    names = {path.name for folder in (a, b) for path in folder.glob("[!.]*")} - {"fit.json", "trace.csv"}
    out = [name for name in sorted(names) if not (a / name).exists() or not (b / name).exists()
           or (a / name).read_bytes() != (b / name).read_bytes()]  # fmt: skip
    return out + (["trace.csv"] if untimed(a / "trace.csv") != untimed(b / "trace.csv") else [])


def main():
    before, after, *texts = sys.argv[1:]
    chosen = [(d, options) for d, options in FITS if not texts or any(text in f"fit {d} {options}" for text in texts)]
    failed = 0
    with tempfile.TemporaryDirectory(prefix="radiafit-same-bits-") as name:
        root = pathlib.Path(name)
        for dataset in ("star", "ornament"):
            run(before, "generate", dataset, "--scale", "smoke", "-o", str(root / dataset))
        for dataset, options in chosen:
            for program, out in ((before, "before"), (after, "after")):
                shutil.rmtree(root / out, ignore_errors=True)
                run(program, "fit", str(root / dataset), *options.split(), "-o", str(root / out))
            wrong = differing(root / "before", root / "after")
            failed += bool(wrong)
            if wrong:
                print(f"fit {dataset} {options}: differs in {' '.join(wrong)}", flush=True)
    print(f"{len(chosen)} fits, {failed} differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
