"""What a reader finds in a folder after something went wrong there: every output whole and old, whole and new, or absent.

An output is a file, or a folder that is written as one (it holds a file of MARKERS). Hidden names are not outputs: they
are what is being written, or what somebody who was killed left; so is OUT.parts, from which a fit goes on.
"""
import csv
import hashlib
import io
import json
import os
import pathlib
import re

from decode import Cut, check_whole

MARKERS = ("dataset.json", "fit.json", "records.json", "run.json", "solution.json", "info.json", "base_colour.png", "index.html", "fusion.cfg")
MADE_BY = ".radiafit-made.json"  # in an output: which command made it
WORD = rb"radiafit_made_by_[a-z_-]+_[0-9a-f]{16}"  # in a file, likewise; in a PNG a chunk, with a checksum behind it
CHUNK = re.compile(rb"....tEXtSoftware\0[a-z_]*" + WORD + rb"....", re.S)
VOLATILE = ("times_s", "seconds", "provenance")  # of fit.json and solution.json: times, and the machine


def outputs(place):
    """Paths of the outputs below `place`, and those of hidden things, by their names relative to it."""
    found, hidden, folders = {}, set(), [pathlib.Path(place)]
    while folders:
        folder = folders.pop()
        for entry in os.scandir(folder):
            name = os.path.relpath(entry.path, place)
            if entry.name == MADE_BY:
                continue
            if entry.name.startswith(".") or entry.name.endswith(".parts"):  # to go on from
                hidden.add(name)
            elif not entry.is_dir(follow_symlinks=False):
                found[name] = pathlib.Path(entry.path)
            elif any(os.path.exists(os.path.join(entry.path, marker)) for marker in MARKERS):
                found[name] = pathlib.Path(entry.path)
            else:
                folders.append(pathlib.Path(entry.path))
    return found, hidden


def files_of(output):
    """(name, bytes) of every file of an output."""
    if output.is_file():
        return [(output.name, output.read_bytes())]
    files = sorted(path for path in output.rglob("*") if not path.is_dir() and path.name != MADE_BY)
    return [(str(path.relative_to(output)), path.read_bytes()) for path in files]


def digest(data):
    return hashlib.sha1(data).hexdigest()


def exact(output):
    """The very bytes."""
    return {name: digest(data) for name, data in files_of(output)}


def table(data):
    return list(csv.reader(io.StringIO(data.decode())))


def without_times(name, data, measured):
    """What two equal runs have in common. `measured`: the output of an experiment, whose rows are times."""
    if measured:
        return (table(data)[0], len(table(data))) if name.endswith(".csv") else "whole"
    if name in ("fit.json", "solution.json"):
        return {key: value for key, value in json.loads(data).items() if key not in VOLATILE}
    if name == "trace.csv":
        rows = table(data)
        at = rows[0].index("time_s")
        return [row[:at] + row[at + 1 :] for row in rows]
    return digest(re.sub(WORD, b"", CHUNK.sub(b"", data)))


def content(output, measured):
    """What an output says, all that differs between equal runs left out. Throws Cut if it isn't whole."""
    result = {}
    for name, data in files_of(output):
        try:
            check_whole(name, data)
            result[name] = without_times(name, data, measured)
        except Cut as cut:
            raise Cut(f"{name}: {cut}") from cut
    return result


def is_measured(name):
    return name.startswith(("results/", "paper_figs/"))


def key_of(name, before):
    """Results of an experiment are named by the time: a run that wasn't there before is 'new'."""
    return os.path.join(os.path.dirname(name), "new") if name.startswith("results/") and name not in before else name


class Contents:
    """What stands in a place at one moment."""

    def __init__(self, place):
        found, self.hidden = outputs(place)
        self.exact = {name: exact(path) for name, path in found.items()}


def reference(place, before):
    """What a run that nothing disturbed left: contents by output. Throws Cut."""
    found, _ = outputs(place)
    return {key_of(name, before.exact): content(path, is_measured(name)) for name, path in found.items()
            if before.exact.get(name) != exact(path)}


def differing(mine, wanted):
    names = sorted(name for name in {*mine, *wanted} if mine.get(name) != wanted.get(name))
    return "".join(f" {name}{'' if name in mine else ' (missing)'}{'' if name in wanted else ' (too many)'}" for name in names)


class Verdict:
    """What stands in `place` now, against `before` and `references` (several: any of them may have come last)."""

    def __init__(self, place, before, references):
        self.before, self.references = before, references
        self.wanted = set().union(*references)
        found, hidden = outputs(place)
        self.leftovers = sorted(hidden - before.hidden)
        self.problems = [f"{name} is gone" for name in sorted(before.hidden - hidden)]
        self.old, self.new = set(), set()
        for name, path in found.items():
            self.look_at(name, path)
        self.missing = sorted(set(before.exact) - set(found))
        self.problems += [f"{name} was there and is gone" for name in self.missing]

    def look_at(self, name, path):
        key = key_of(name, self.before.exact)
        if exact(path) == self.before.exact.get(name):
            self.old.add(key)
        if key not in self.wanted:
            if key not in self.old:
                self.problems.append(f"{name} is {'changed' if key in self.before.exact else 'there, and nobody writes it'}")
            return
        try:
            mine = content(path, is_measured(name))
        except Cut as cut:
            if key not in self.old:
                self.problems.append(f"{name} stands there cut: {cut}")
            return
        wanted = [reference[key] for reference in self.references if key in reference]
        if mine in wanted:
            self.new.add(key)
        elif key not in self.old:
            self.problems.append(f"{name} is neither the old nor the new one:{differing(mine, wanted[0])}")

    def after_success(self):
        """Violations after exit 0: all is new, and nothing lies about."""
        late = [f"{key} is not the new one, with exit 0" for key in sorted(self.wanted - self.new) if key not in self.missing]
        return self.problems + late + [f"leftover {name}" for name in self.leftovers]

    def all_new(self):
        return self.new >= self.wanted

    def after_kill(self):
        """Violations after a kill: leftovers are for the next run to clean."""
        return self.problems

    def after_failure(self, steps):
        """Violations after another exit: nothing has changed. `steps`: a command of several outputs, whose first may
        be whole."""
        changed = [] if steps else [f"{key} is the new one, though the run failed" for key in sorted(self.new - self.old)]
        return self.problems + changed + [f"leftover {name}" for name in self.leftovers]
