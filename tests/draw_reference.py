#!/usr/bin/env python3
"""Whether today's programs still draw every run of results/reference, however old: `EXPERIMENT --run RUN --output FOLDER`.
Usage: draw_reference.py BUILD     its experiments must be built"""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def drawer(name, build):
    script = ROOT / f"experiments/{name}/{name}.py"
    return ["/usr/bin/python3", "-B", script] if script.exists() else [build / "experiments" / name]


def main(build):
    runs = sorted(path.parent for path in (ROOT / "results/reference").glob("*/*/*/run.json"))
    failed = 0
    for run in runs:
        name = run.parts[-3]
        with tempfile.TemporaryDirectory() as folder:
            told = subprocess.run([*drawer(name, build), "--run", run, "--output", f"{folder}/drawn"], cwd=ROOT, capture_output=True,
                                  text=True)  # fmt: skip
            expected = f"{name}.png" if (ROOT / f"paper_figs/{name}.gp").exists() else f"{name}.md"
            drawn = any(path.name == expected and path.stat().st_size for path in pathlib.Path(folder).rglob("*"))
        if told.returncode or not drawn:
            failed += 1
            print(f"{run.relative_to(ROOT)}: {told.stderr.strip() or 'no ' + expected}")
    print(f"{len(runs) - failed} of {len(runs)} runs of results/reference are drawn")
    return bool(failed or not runs)


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
