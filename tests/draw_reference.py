#!/usr/bin/env python3
"""Whether today's programs still draw every run of results/reference, however old: `EXPERIMENT --run RUN --output FOLDER`.
Usage: draw_reference.py BUILD"""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main(build):
    runs = sorted(path.parent for path in (ROOT / "results/reference").glob("*/*/*/run.json"))
    failed = 0
    for run in runs:
        with tempfile.TemporaryDirectory() as folder:
            told = subprocess.run([build / "experiments" / run.parts[-3], "--run", run, "--output", f"{folder}/drawn"], cwd=ROOT,
                                  capture_output=True, text=True)  # fmt: skip
            drawn = any(path.stat().st_size for path in pathlib.Path(folder).rglob("*.png"))
        if told.returncode or not drawn:
            failed += 1
            print(f"{run.relative_to(ROOT)}: {told.stderr.strip() or 'no figure'}")
    print(f"{len(runs) - failed} of {len(runs)} runs of results/reference are drawn")
    return bool(failed or not runs)


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
