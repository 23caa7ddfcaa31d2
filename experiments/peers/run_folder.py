"""A folder of results as the other experiments leave them: rows, run.json, a figure. docs/formats.md has run.json's fields."""
import contextlib
import csv
import datetime
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import time
import zlib


def utc_now():
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def slug(text):
    return re.sub("[^a-z0-9]+", "-", text.lower()).strip("-")


class RunFolder:
    """RESULTS/NAME/DEVICE/UTC-REVISION, hidden until commit(). record: of `radiafit export`, which tells build and machine."""

    def __init__(self, results, name, record, arguments):
        self.begun, self.start = time.monotonic(), utc_now()
        self.record = {**record, "program": name, "arguments": arguments, "utc_start": self.start}
        self.device = f"{record['cpu']}, {record['threads']} thread{'s' if record['threads'] > 1 else ''}"
        run = f"{re.sub('[-:]', '', self.start)}-{record['git_revision']}"
        self.target = pathlib.Path(results) / name / slug(self.device) / run
        self.path = self.target.with_name(f".radiafit-tmp-{os.getpid()}-{time.time_ns() // 10**6}-{run}")
        self.made = [parent for parent in self.target.parents if not parent.exists()]
        self.path.mkdir(parents=True)

    def write(self, name, rows):
        with open(self.path / name, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)

    def commit(self, **fields):
        own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        files = {path.name: {"bytes": path.stat().st_size, "crc32": f"{zlib.crc32(path.read_bytes()):08x}"}
                 for path in sorted(self.path.glob("*.csv"))}  # fmt: skip
        record = {**self.record, "utc_end": utc_now(), **fields, "wall_s": round(time.monotonic() - self.begun, 3),
                  "cpu_s": round(sum(u.ru_utime + u.ru_stime for u in (own, children)), 3),
                  "peak_memory_bytes": 1024 * max(own.ru_maxrss, children.ru_maxrss), "files": files}  # fmt: skip
        (self.path / "run.json").write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
        self.path.rename(self.target)
        self.path = self.target

    def discard(self):
        """What was not committed goes."""
        if self.path != self.target:
            shutil.rmtree(self.path, ignore_errors=True)
            with contextlib.suppress(OSError):  # where others put something meanwhile
                for parent in self.made:
                    parent.rmdir()


def draw(script, rows, caption, folder):
    """folder/NAME.svg and .png by gnuplot, over earlier ones."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for terminal in ("svg", "png"):
        target = folder / f"{script.stem}.{terminal}"
        hidden = target.with_name(f".radiafit-tmp-{os.getpid()}-{time.time_ns() // 10**6}-{target.name}")
        values = {"rows": str(rows), "caption": caption, "terminal": terminal, "output": str(hidden)}
        definitions = [word for name, value in values.items() for word in ("-e", f"{name}='{value.replace(chr(39), 2 * chr(39))}'")]
        try:
            command = ["env", "-u", "GNUTERM", "gnuplot", "-d", *definitions, script]
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
            if done.returncode:
                raise OSError(f"gnuplot {script} ended with status {done.returncode}: {' '.join(done.stderr.split())}")
            hidden.rename(target)
        finally:
            hidden.unlink(missing_ok=True)
        drawn.append(target)
    return drawn
