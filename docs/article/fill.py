#!/usr/bin/env python3
"""Fills docs/article/article.md, below metadata.yaml, with what was measured: build/article/article.md.

    fill.py [--root ROOT] [--programs FOLDER]    FOLDER: of the experiments' programs, to draw the figures as well

What stands between {{ and }} is a Python expression, with ` as FORMAT` behind it or not; the comment `<!-- fill ... -->` at the
text's top has definitions for it. It knows

    C1 ... C23            a claim of results/reference/claims.json, as judged from the run at the paper's scale that is told first:
                          C1.verdict, C1.sentence, every other field there, C1.told and C1.run
    claims                all of them: claims.counted, claims.of("holds"), claims.table, ...
    paper.solvers         the newest run of an experiment at a profile, paper or standard: what its run.json says, such as
                          paper.solvers.config, and its files of rows: paper.solvers.vertices
    rows(column="value")  rows of a file with that value; rows.column: the value of the only one; rows.all("column"): of all
    cells(*values)        a row of a table: texts, or pairs of a number and its FORMAT
    mean, median, sure(condition), figure(run), machine(run), newest(profile), sources(), authors(), and Python's own

A number is shown with three digits, or as many as FORMAT says; `%` makes it percent, `,` a whole number; `+.2f` and the like are
Python's. After numbers of a file of rows comes a mark, r1, that the list of sources() explains; those of a table stand in its
caption. A paragraph has to name the claims that it tells of.

What has no value is refused in one line. So is a `sure` whose condition the rows do not bear out: the sentence beside it must
then be written anew.
"""
import argparse
import csv
import gzip
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys

PLACEHOLDER = re.compile(r"\{\{(.+?)\}\}", re.S)
DEFINITIONS = re.compile(r"<!-- fill\n(.*?)-->\n", re.S)
CLAIM = re.compile(r"\bC\d+\b")
VERDICTS = {"holds": ("holds", "hold"), "does not hold": ("does not hold", "do not hold"), "undecided": ("is undecided", "are undecided"),
            "not comparable": ("is not comparable", "are not comparable"), "not run": ("was not run", "were not run")}  # fmt: skip
SILENT = ("not run", "not comparable")


class Missing(Exception):
    """What a placeholder asks for is not there."""


def listed(parts):
    """'a, b and c'"""
    parts = list(parts)
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def plain(text):
    """So that Markdown takes it for text."""
    return re.sub(r"([\\`*_{}\[\]<>$^~|@#])", r"\\\1", str(text))


def digits(value, count):
    """Without an exponent; whole numbers without decimals."""
    decimals = 0 if value == round(value) else max(0, count - 1 - math.floor(math.log10(abs(value))))
    return "\N{MINUS SIGN}" * (value < 0) + f"{abs(value):,.{decimals}f}"


def shown(value, how):
    """A placeholder's value as text."""
    if value is True:  # of a condition
        return ""
    if isinstance(value, str) and not how:
        if not value:
            raise Missing("no value")
        return value
    if isinstance(value, str | bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise Missing("no number")
    if how == ",":
        return digits(round(value), 1)
    match = re.fullmatch(r"(%?)(\d*)", how)
    if not match:
        text = format(value, how)
        return text.replace("-", "\N{MINUS SIGN}") if float(text) else text.lstrip("+-")
    return digits(value * (100 if match[1] else 1), int(match[2] or 3)) + (" %" if match[1] else "")


def cells(*values):
    return "| " + " | ".join(v if isinstance(v, str) else shown(*v) for v in values) + " |"


class Rows:
    """Some rows of one file. `read` is told of every file whose values are asked for."""

    def __init__(self, path, rows, read):
        self._path, self._rows, self._read = path, rows, read

    def __call__(self, **wanted):
        def same(row, column, value):
            if column not in row:
                raise Missing(f"{self._path} has no column {column}")
            try:
                return row[column] == str(value) or float(row[column]) == float(value)
            except ValueError:
                return False

        found = [r for r in self._rows if all(same(r, c, v) for c, v in wanted.items())]
        if not found:
            raise Missing(f"{self._path} has no row with {listed(f'{c} = {v}' for c, v in wanted.items())}")
        return Rows(self._path, found, self._read)

    def all(self, column):
        self._read(self._path)
        for row in self._rows:
            if not row.get(column):
                raise Missing(f"{self._path} has no {'value in ' if column in row else ''}column {column}")
        try:
            return [float(row[column]) for row in self._rows]
        except ValueError:
            return [row[column] for row in self._rows]

    def __iter__(self):
        return (Rows(self._path, [row], self._read) for row in self._rows)

    def __len__(self):
        self._read(self._path)
        return len(self._rows)

    def __getattr__(self, column):
        if len(self._rows) != 1:
            raise Missing(f"{self._path} has {len(self._rows)} rows for {column}, where one is wanted")
        return self.all(column)[0]


class Run:
    """One run of an experiment: what run.json says, and files of rows, packed or not."""

    def __init__(self, root, folder, read):
        self.folder, self._root, self._read, self._files = folder, root, read, {}
        self.about = json.loads((folder / "run.json").read_text(encoding="utf-8"))

    @property
    def name(self):
        return str(self.folder.relative_to(self._root))

    def __getattr__(self, name):
        paths = [p for p in (self.folder / f"{name}.csv", self.folder / f"{name}.csv.gz") if p.exists()]
        if name not in self._files and paths:
            with gzip.open(paths[0], "rt", encoding="utf-8") if paths[0].suffix == ".gz" else open(paths[0], encoding="utf-8") as file:
                self._files[name] = Rows(str(paths[0].relative_to(self._root)), list(csv.DictReader(file)), self._read)
        if name in self._files:
            return self._files[name]
        if name in self.about:
            return self.about[name]
        raise Missing(f"{self.name} has no {name}.csv, and its run.json no {name}")


class Profile:
    """Of each experiment the newest run at one profile, with no setting of its own, on whatever machine, if there is one whose rounds
    are all there: names of runs begin with their time."""

    def __init__(self, name, runs):
        self._name = name
        self.runs = {run.about["program"]: run for run in sorted(runs, key=lambda r: (not r.about.get("rounds_left_out", False), r.folder.name))
                     if run.about["profile"] == name and run.about.get("standard", True)}  # fmt: skip

    def __getattr__(self, experiment):
        if experiment not in self.runs:
            raise Missing(f"results/reference has no run of {experiment} at the {self._name} profile")
        return self.runs[experiment]


class Claim:
    """What one run says of a claim, by the fields of claims.json."""

    def __init__(self, entry, runs):
        self.entry, self._runs = entry, runs

    def __getattr__(self, field):
        if field == "run":
            if self.entry["run"] not in self._runs:
                raise Missing(f"results/reference has no run that {self.entry['id']} is judged from")
            return self._runs[self.entry["run"]]
        if field not in self.entry:
            raise Missing(f"claims.json has no {field} of {self.entry['id']}")
        value = self.entry[field]
        return plain(value) if isinstance(value, str) else value

    @property
    def others(self):
        """Verdicts by other readings, and by former rules that say something else: "as mathematics: undecided"."""
        former = [r for r in self.entry.get("former", []) if r["verdict"] != self.entry["verdict"]]
        return [f"{r['name']}: {r['verdict']}" for r in self.entry.get("readings", [])] + [
            f"by the rule until {r['until']}: {r['verdict']}" for r in former]  # fmt: skip

    @property
    def told(self):
        """The verdict, and behind it the others: "**holds**; as mathematics: undecided"."""
        return "; ".join([f"**{self.entry['verdict']}**", *self.others])


class Claims:
    def __init__(self, entries, runs):
        def weight(entry):
            return (entry["verdict"] != "not run", entry["verdict"] not in SILENT, entry.get("told_first", False),
                    pathlib.PurePath(entry["run"]).name)  # fmt: skip

        self._all = {}  # [id], of every machine
        for entry in entries:
            if entry["profile"] == "paper":
                self._all.setdefault(entry["id"], []).append(entry)
        ids = sorted(self._all, key=lambda id: int(id[1:]))
        self._claims = {id: Claim(max(self._all[id], key=weight), runs) for id in ids}

    def __getitem__(self, id):
        if id not in self._claims:
            raise Missing(f"claims.json has no {id} at the paper's scale")
        return self._claims[id]

    def where(self, condition):
        """The claims whose entry in claims.json has it, or "all", or "none"."""
        found = [id for id, claim in self._claims.items() if condition(claim.entry)]
        return "all" if 1 < len(found) == self.count else listed(found) or "none"

    def of(self, verdict):
        return self.where(lambda entry: entry["verdict"] == verdict)

    @property
    def count(self):
        return len(self._claims)

    @property
    def counted(self):
        """'10 hold, 2 do not hold and 1 is undecided'"""
        verdicts = [claim.entry["verdict"] for claim in self._claims.values()]
        if unknown := set(verdicts) - set(VERDICTS):
            raise Missing(f"claims.json has a verdict that has no word here: {listed(unknown)}")
        return listed(f"{verdicts.count(v)} {words[verdicts.count(v) > 1]}" for v, words in VERDICTS.items() if v in verdicts)

    @property
    def table(self):
        lines = ["| | the paper states | verdict | found |", "|--|-------|------|-------------------|"]
        for id, claim in self._claims.items():
            entry = claim.entry
            paper = f"{plain(entry['paper'])} ({plain(entry['section'])})"
            lines.append(cells(id, paper, claim.told, plain(entry["sentence"]) or "—"))
        return "\n".join(lines)

    @property
    def reasons(self):
        """Why a verdict is no plain yes or no: a list, by reason."""
        ids = {}
        for id, claim in self._claims.items():
            if claim.entry["reason"]:
                ids.setdefault((claim.entry["verdict"], claim.entry["reason"]), []).append(id)
        return "\n".join(f"- {listed(of)}, {verdict}: {plain(reason)}." for (verdict, reason), of in ids.items()) or "- None."

    @property
    def younger(self):
        """Claims whose rule is younger than their rows."""
        if not all("rule_is_younger_than_rows" in claim.entry for claim in self._claims.values()):
            return "not known, since this `claims.json` does not say"
        return self.where(lambda entry: entry["rule_is_younger_than_rows"])

    @property
    def machines(self):
        """What several machines say of the same claim."""
        said = {id: [e["verdict"] for e in found if e["verdict"] not in SILENT] for id, found in self._all.items()}
        alike = self.where(lambda e: len(said[e["id"]]) > 1 and len(set(said[e["id"]])) == 1)
        apart = self.where(lambda e: len(set(said[e["id"]])) > 1)
        return f"for {alike} the verdict is the same, for {apart} it differs"


class Text:
    """Fills texts, one after the other."""

    def __init__(self, root):
        self.root, self.drawn, self._sources, self._read = root, {}, [], []
        folders = [path.parent for path in sorted((root / "results/reference").glob("*/*/*/run.json"))]
        runs = {run.name: run for run in (Run(root, folder, self._read.append) for folder in folders)}
        claims = json.loads((root / "results/reference/claims.json").read_text(encoding="utf-8"))["claims"]
        profiles = {name: Profile(name, runs.values()) for name in ("paper", "standard")}
        self._claims = Claims(claims, runs)
        self._known = {**profiles, "claims": self._claims, "newest": lambda profile: list(profiles[profile].runs.values()),
                       "mean": statistics.fmean, "median": statistics.median, "plain": plain, "listed": listed, "cells": cells,
                       "digits": digits, "sure": self.sure, "figure": self.figure, "machine": self.machine, "sources": self.sources,
                       "authors": self.authors}  # fmt: skip

    def sure(self, condition):
        if not condition:
            raise Missing("the rows no longer bear this out: write the sentence anew")
        return True

    def figure(self, run):
        """Its file's name; it is drawn from this run."""
        self.drawn[run.about["program"]] = run
        return f"{run.about['program']}.svg"

    def machine(self, run):
        memory, system = run.machine["memory_bytes"] / 1e9, run.machine["distribution"]
        return plain(f"{run.cpu}, {run.threads} threads, {memory:.0f} GB of memory, {system}, {run.compiler.split(' -')[0]}")

    def sources(self):
        paths = [path.removeprefix("results/reference/") for path in self._sources]
        return "\n".join(f"- []{{#r{i}}}r{i}: `{path}`" for i, path in enumerate(paths, 1)) or "- None."

    def authors(self):
        text = (self.root / "CITATION.cff").read_text(encoding="utf-8")
        of_software = re.search(r"^authors:\n((?: .*\n)+)", text, re.M)[1]
        return listed(re.findall(r"^ *- name: (.+)$", of_software, re.M))

    def marks(self, files):
        self._sources += [file for file in dict.fromkeys(files) if file not in self._sources]
        return ", ".join(f"[r{i}](#r{i})" for i, file in enumerate(self._sources, 1) if file in files)

    def value(self, placeholder, told):
        """Its text, and the files of rows that it is from. `told`: what its paragraph says itself."""
        expression, _, how = placeholder.strip().partition(" as ")
        ids = set(CLAIM.findall(expression))
        for id in ids:
            if not re.search(rf"\b{id}\b", told):
                raise Missing(f"the paragraph does not name {id}")
        self._read.clear()
        try:
            value = eval(expression, self._known | {id: self._claims[id] for id in ids})
        except Missing:
            raise
        except Exception as fault:  # a wrong expression may do anything
            raise Missing(f"{type(fault).__name__}: {fault}") from fault
        return shown(value, how.strip()), list(dict.fromkeys(self._read))

    def paragraph(self, text, where):
        """Filled, and the files of rows that it is from. `where`: names the place of an index in the text."""
        told, found = PLACEHOLDER.sub("", text), []
        for match in PLACEHOLDER.finditer(text):
            try:
                found.append((match, *self.value(match[1], told)))
            except Missing as fault:
                raise Missing(f"{where(match.start())}: {match[0]}: {fault}") from fault
        files = [file for _, value, read in found if value for file in read]
        if text.startswith("|") or (found and found[0][1].startswith("|")):  # a table, whose caption has the marks
            return PLACEHOLDER.sub(lambda match: next(v for m, v, _ in found if m.start() == match.start()), text), files
        found = [one for one in found if one[1]]
        filled = PLACEHOLDER.sub("", text[: found[0][0].start()] if found else text)
        for i, (match, value, read) in enumerate(found):
            rest = PLACEHOLDER.sub("", text[match.end() : found[i + 1][0].start() if i + 1 < len(found) else len(text)])
            following = next((other for _, _, other in found[i + 1 :] if other), None)
            if read and read != following:  # the mark comes where this part of the sentence ends
                end = re.search(r"[.,;:)](?=\s|$)", rest)
                stop = end.start() if end else 0
                rest = f"{rest[:stop]}^{self.marks(read)}^{rest[stop:]}"
            filled += value + rest
        return filled, files

    def fill(self, path):
        text, name = path.read_text(encoding="utf-8"), path.relative_to(self.root)
        if definitions := DEFINITIONS.search(text):
            try:
                exec(definitions[1], self._known)
            except Exception as fault:
                raise Missing(f"{name}: its definitions: {type(fault).__name__}: {fault}") from fault
            text = text.replace(definitions[0], "\n" * definitions[0].count("\n"), 1)
        filled, at, of_table = [], 0, []  # files of the table above
        for part in re.split(r"(\n{2,})", text):
            done, files = self.paragraph(part, lambda i, at=at: f"{name}:{text.count(chr(10), 0, at + i) + 1}")
            if of_table and part.startswith(": "):  # its caption
                done = f"{done.rstrip()} Rows: {self.marks(of_table)}."
            if part.strip():
                of_table = files if done.startswith("|") else []
            filled.append(done)
            at += len(part)
        return "".join(filled).strip() + "\n"


def draw(text, programs, output):
    for name, run in text.drawn.items():
        program = programs / name
        if not program.exists():
            raise Missing(f"{program} is not built, which draws a figure")
        drawn = subprocess.run([program, "--config", text.root / f"experiments/{name}.toml", "--run", run.folder, "--output", output],
                               stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)  # fmt: skip
        if drawn.returncode:
            raise Missing(f"{name} does not draw {run.name}: {drawn.stderr.strip().splitlines()[-1]}")
        file = output / f"{name}.svg"  # points of no size, by which gnuplot draws intervals, are an error to what makes PDF of it
        file.write_text(re.sub(r"<use [^>]*scale\(0\.00\)[^>]*/>", "", file.read_text(encoding="utf-8")), encoding="utf-8")


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2])
    options.add_argument("--programs", type=pathlib.Path)
    options = options.parse_args()
    root, output = options.root.resolve(), options.root.resolve() / "build/article"
    try:
        text = Text(root)
        article = text.fill(root / "docs/article/article.md")
        filled = f"---\n{text.fill(root / 'docs/article/metadata.yaml')}---\n\n{article}"
        output.mkdir(parents=True, exist_ok=True)
        if options.programs:
            draw(text, options.programs.resolve(), output)
        (output / "article.md").write_text(filled, encoding="utf-8")
    except (Missing, OSError) as fault:
        print(f"fill.py: {fault}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
