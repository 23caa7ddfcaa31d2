#!/usr/bin/env python3
"""What a reader finds after runs were killed, disks were full, several wrote at once, and inputs changed midway.

usage: faults.py BUILD [--count N] [--seed N] [--only TEXT] [--jobs N]

Every command of the program and an experiment is run on small synthetic inputs, in a temporary folder, and disturbed.
Each output must then be whole and old, whole and new, or absent; nothing older is lost; exit status 0 means that all is
there; and what killed runs left goes with the next run. One line is printed per kind of fault and command, and every
violation with what it takes to see it again; the exit status is 1 if there are any. Random moments follow from the seed.
"""
import argparse
import concurrent.futures
import os
import pathlib
import shutil
import sys
import time

import full_disk
import kills
import resumes
import swaps
import syscalls
import unasked
import writers
from scene import Scene


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="where radiafit and the experiments were built")
    parser.add_argument("--count", type=int, default=3, help="kills, failing calls, swaps per command and state (3)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="kinds and commands whose line contains this, such as 'kills, render'")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    return parser.parse_args()


def chosen_tasks(scene, options):
    traced = syscalls.can_trace()
    mounting = full_disk.can_mount(scene.root / "mount")
    if not traced:
        print("no strace here, or it may not trace: nothing is killed at a rename, and no single call fails")
    if not mounting:
        print("no file system may be mounted here: instead, files may not grow beyond a size")
    all_tasks = [
        *kills.tasks(scene, options.count, options.seed, traced),
        *resumes.tasks(scene, options.count, options.seed),
        *full_disk.tasks(scene, options.count, options.seed, traced, mounting),
        *writers.tasks(scene, options.count),
        *swaps.tasks(scene, options.count, options.seed),
        *unasked.tasks(scene),
    ]
    return [task for task in all_tasks if options.only in task.tally.name]


def run(task, options):
    try:
        task.run()
    except Exception as error:  # one kind that cannot be run doesn't keep the others from running
        task.tally.violations.append(f"could not go on: {type(error).__name__}: {error}")
    lines = [task.tally.line(), *(f"    {violation}" for violation in task.tally.violations)]
    if task.tally.violations:
        lines.append(f"    again: --seed {options.seed} --count {options.count} --only '{task.tally.name}'")
    print("\n".join(lines), flush=True)


def main():
    options = arguments()
    start = time.monotonic()
    scene = Scene(options.build.resolve())
    try:
        tasks = chosen_tasks(scene, options)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(lambda task: run(task, options), tasks))
    finally:
        shutil.rmtree(scene.root, ignore_errors=True)
    runs, hits, violations = (sum(numbers) for numbers in zip(*(
        (task.tally.runs, task.tally.hits, len(task.tally.violations)) for task in tasks)))
    print(f"{runs} runs, {hits} hit, {violations} violations in {time.monotonic() - start:.0f} s, seed {options.seed}")
    return 1 if violations or not runs else 0


if __name__ == "__main__":
    sys.exit(main())
