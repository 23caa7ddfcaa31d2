#!/usr/bin/env python3
"""What a profile needs, by the runs in results/reference: hours, memory and disk.

    profile-needs.py PROFILE EXPERIMENT...
"""
import csv
import json
import pathlib
import sys


def main(profile, names):
    wall = memory = scratch = 0
    datasets, missing, machines = {}, [], set()
    for name in names:
        runs = sorted(pathlib.Path("results/reference", name).glob("*/*/run.json"), key=lambda path: path.parent.name)
        records = [(path.parent, json.loads(path.read_text())) for path in runs]
        records = [(folder, record) for folder, record in records if record.get("profile") == profile and record.get("standard", True)]
        records.sort(key=lambda pair: not pair[1].get("rounds_left_out", False))  # last the newest of those that ran whole
        if not records:
            missing += [name] if name not in ("claims", "report") else []  # which measure nothing
            continue
        folder, record = records[-1]
        wall += record["wall_s"]
        memory = max(memory, record.get("peak_memory_bytes", 0))
        machines.add(f"{record['cpu']}, {record['cores']} cores")
        datasets.update({d["checksum"]: d.get("bytes", 0) for d in record.get("datasets", [])})
        for table in folder.glob("*.csv"):  # records that the two-step baseline writes, one method at a time
            with open(table, newline="", encoding="utf-8") as file:
                scratch = max([scratch] + [int(row["bytes_written"]) for row in csv.DictReader(file) if row.get("bytes_written")])
    if machines:
        time = f"{wall / 3600:.1f} h" if wall > 5400 else f"{wall / 60:.0f} min"
        print(f"the {profile} profile took {time} on {'; '.join(sorted(machines))}, at most {memory / 1e9:.1f} GB of memory, and "
              f"{(sum(datasets.values()) + scratch) / 1e9:.1f} GB of disk")
    if missing:
        print(f"no {profile} run to tell the needs of:", *missing)


main(sys.argv[1], sys.argv[2:])
