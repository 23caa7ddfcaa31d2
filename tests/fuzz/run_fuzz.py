#!/usr/bin/env python3
"""Runs fuzzing targets for some minutes each: what `make fuzz MINUTES=n [ONLY=png]` calls.

Usage: run_fuzz.py PROGRAM FOLDER --minutes N [--only TEXT] [--jobs N]
FOLDER keeps what was learnt for the next time: corpus/TARGET, findings/TARGET-*, logs/TARGET.txt, and fuzz.csv, a line
per run of a target. Exit status 1 if there is a finding; its file is named."""
import argparse
import concurrent.futures
import csv
import datetime
import os
import pathlib
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
LIMITS = ["-timeout=120", "-report_slow_units=20", "-rss_limit_mb=512", "-malloc_limit_mb=256", "-detect_leaks=0"]
# What is freed is kept back for a while to catch its use; the default would fill the whole limit.
SANITIZERS = {"ASAN_OPTIONS": "quarantine_size_mb=16", "UBSAN_OPTIONS": "print_stacktrace=1",
              "LSAN_OPTIONS": f"suppressions={HERE}/leaks.txt:print_suppressions=0"}  # fmt: skip


def dictionaries(target):
    """Those whose name is a part of the target's."""
    return [f"-dict={file}" for file in (HERE / "dictionaries").glob("*.dict") if file.stem in target][:1]


def command(program, folder, target, minutes):
    corpus, seeds = folder / "corpus" / target, folder / "seeds" / target
    corpus.mkdir(parents=True, exist_ok=True)
    (folder / "findings").mkdir(exist_ok=True)
    found = HERE / "regressions" / target
    return [
        str(program), f"--target={target}", f"--seeds={seeds}",
        f"-max_total_time={round(60 * minutes)}", "-print_final_stats=1", "-print_funcs=0", *LIMITS, *dictionaries(target),
        f"-artifact_prefix={folder}/findings/{target}-", str(corpus), str(seeds),
        *([str(found)] if found.is_dir() else []),
    ]  # fmt: skip


def statistic(log, name):
    found = re.search(rf"stat::{name}:\s*(\d+)", log)
    return int(found[1]) if found else 0


def run(program, folder, target, minutes):
    findings = set((folder / "findings").glob(f"{target}-*"))
    log_file = folder / "logs" / f"{target}.txt"
    log_file.parent.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic()
    with open(log_file, "wb") as log:
        process = subprocess.Popen(
            command(program, folder, target, minutes), stdout=log, stderr=log, env={**os.environ, **SANITIZERS}
        )
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    log = log_file.read_text(errors="replace")
    new = sorted(set((folder / "findings").glob(f"{target}-*")) - findings)
    return {
        "utc": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "target": target,
        "executions": statistic(log, "number_of_executed_units"),
        "new_inputs": statistic(log, "new_units_added"),
        "peak_mb": statistic(log, "peak_rss_mb"),
        "wall_s": round(time.monotonic() - begin, 1),
        "cpu_s": round(usage.ru_utime + usage.ru_stime, 1),
        "status": process.returncode,
        "findings": " ".join(map(str, new)) or (f"see {log_file}" if process.returncode else ""),
    }


def keep(folder, row):
    file = folder / "fuzz.csv"
    fresh = not file.exists()
    with open(file, "a", newline="") as stream:
        writer = csv.DictWriter(stream, row)
        if fresh:
            writer.writeheader()
        writer.writerow(row)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, required=True)
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    folder = args.folder.resolve()
    names = subprocess.run([args.program, "--list"], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
    names = [name for name in names if args.only in name]
    if not names:
        sys.exit(f"--only {args.only}: no target has that in its name")
    failed = False
    print(f"{'target':24}{'executions':>12}{'CPU s':>9}{'new':>7}{'peak MB':>9}  finding", flush=True)
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for row in pool.map(lambda name: run(args.program.resolve(), folder, name, args.minutes), names):
            keep(folder, row)
            failed |= row["status"] != 0
            print(f"{row['target']:24}{row['executions']:>12}{row['cpu_s']:>9}{row['new_inputs']:>7}"
                  f"{row['peak_mb']:>9}  {row['findings'] or 'none'}", flush=True)  # fmt: skip
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
