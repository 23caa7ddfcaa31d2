#!/usr/bin/env python3
"""Numbers that README.md and docs/*.md print of measurements are those of rows in results/reference. A comment behind a paragraph
or table, which no reader sees, says where its numbers are from:

    <!-- figures
    rows: solvers paper family 26
    ms(name, setting="") = 1000 * solvers(solver=name, setting=setting).seconds_to_101 / 200
    0.79 ms: ms("varpro")
    99.8 against 91.7 %: (share("ceres"), share("two-step")) as %
    64,000: times(method="TinySolver").fits_per_s as 2
    a fourth of the time: 0.2 < ms("ceres", "lbfgs") / ms("two-step", "cg paper") < 0.3
    1 %: given
    -->

`rows:` takes the newest run, cut short or not, of an experiment at a profile on a machine, which its processor's or renderer's name or number says. From there on
its files of rows have their names, as in docs/article/fill.py: file(column="value") are the rows with that value, .column the
value of the only one, .all("column") those of all; what its run.json says has its name, too. newest("standard", "family 26") are
all such runs. `name = ...` and `name(...) = ...` abbreviate an expression for the rest of the page.

Before a colon stands a piece of the text, in the order of the text, and behind it an expression with a value, or (values), for
its numbers. A value has to be the printed number when it is rounded to the number's own last digit; `as 2` to two digits, `as %`
makes it percent, `as %2` both. Where the expression is a condition it has to be true. In place of an expression:

    given         no measurement of ours: a setting, a bound, what a capture has, what would be
    paper         the paper says so
    once          it has no rows; the section says 'measured once', and on what
    tests/a.py    that file checks it, and has these numbers

and `*` is all that stands in the text. Every number of a time, size, share or error needs such a piece, but on pages of NOT_HELD. The
section of numbers that have rows must name the experiment and the machine.

    check_figures.py [--write] [ROOT]    --write: corrects the numbers
"""
import argparse
import json
import math
import pathlib
import re
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "docs/article"))
import fill

NOT_HELD = {  # pages without measurements of ours: why
    "docs/formats.md": "constants of formats",
    "docs/options.md": "the program prints it",
    "docs/results.md": "a program prints it: columns and their units",
}
COMMENT = re.compile(r"<!-- figures\n(.*?)-->", re.S)
NAMED = re.compile(r"([a-z]\w*)(\([^)]*\))? = (.+)")
NUMBER = r"\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d+(?:\.\d+)?"
PRINTED = re.compile(rf"(?<![\w.,])[-+\N{{MINUS SIGN}}]?(?:{NUMBER})(?![\d])|(?<=\s)[-+\N{{MINUS SIGN}}](?:{NUMBER})")
UNIT = r"(?:[mµn]?s|seconds?|minutes?|hours?|milliseconds?|dB|decibels?|[kMGT]i?B|[\w]+/s|°|degrees|%|times)(?!\w)"
JOINED = r"(?:\s+(?:to|and|or|against|in place of)\s+|\s*[,;/–]\s*)"
WORD = "one|two|three|four|five|six|seven|eight|nine|ten|twenty|thirty|hundred|thousand|half a"
MEASURE = re.compile(rf"(?<![\w.,])(?:{NUMBER})(?:{JOINED}(?:{NUMBER}))*\s*{UNIT}|(?<![\w.,])\d+\.\d+(?![\w.]*\d)|"
                     rf"\b(?:{WORD})\s+(?:seconds?|minutes?|hours?|milliseconds?|decibels?|times)\b")  # fmt: skip
COLUMN = re.compile(r"\b(?:dB|APE|PSNR|[mµn]s|seconds|minutes|time|GB|MB|share|rate)(?!\w)")
FENCED = re.compile(r"^```.*?^```", re.M | re.S)
NO_PROSE = re.compile(r"^```.*?^```|^    .*?$|^#+ .*?$|<!--.*?-->|`[^`\n]*`|\]\([^)\s]*\)", re.M | re.S)
EXEMPT = ("given", "paper", "once")


class Fault(Exception):
    """What a line of a comment asks for is not there."""


class Names(dict):
    """What expressions know: what is defined on the page, and files and fields of the run at hand."""

    run = None

    def __missing__(self, name):
        if self.run is None:
            raise KeyError(name)
        try:
            return getattr(self.run, name)
        except fill.Missing:
            raise KeyError(name) from None


class Runs:
    def __init__(self, root):
        self.root, self._runs = root, {}
        for path in (root / "results/reference").glob("*/*/*/run.json"):
            run = fill.Run(root, path.parent, lambda _: None)
            self._runs[path.parent] = run

    def newest(self, profile, machine):
        """{experiment: run}"""
        found = {}
        for folder, run in sorted(self._runs.items(), key=lambda one: one[0].name):
            computer = f"{run.about['cpu']} {run.about.get('machine', {}).get('cpu_id', '')} {run.about.get('gl', {}).get('renderer', '')}"
            usual = run.about.get("standard", True) or run.about["program"] == "bench"  # of any number of rounds
            if run.about["profile"] == profile and usual and re.search(rf"{re.escape(machine)}(?!\w)", computer):
                found[run.about["program"]] = run
        return found


def blank(match):
    """In its place, so that what stands behind it keeps its own."""
    return re.sub(r"[^\n]", " ", match[0])


def value_of(number):
    return float(number.replace(",", "").replace("\N{MINUS SIGN}", "-"))


def as_printed(value, number, how):
    """`value` in the place of `number`: as it stands, where it rounds to it."""
    value *= 100 if "%" in how else 1
    decimals = len(number.partition(".")[2])
    step = 10.0**-decimals
    if how.strip("%") and value:
        places = int(how.strip("%")) - 1 - math.floor(math.log10(abs(value)))
        step, decimals = 10.0**-places, max(0, places)
    if abs(value - value_of(number)) <= step * (0.5 + 1e-6):
        return number
    text = f"{abs(round(value / step) * step):,.{decimals}f}"
    sign = "\N{MINUS SIGN}" if value < 0 else "+" if number.startswith("+") else ""
    return sign + text


class Page:
    def __init__(self, path, root, runs):
        self.path, self.root, self.runs = path, root, runs
        self.name, self.text = str(path.relative_to(root)), path.read_text(encoding="utf-8")
        self.errors, self.edits, self.count = [], [], 0
        self.covered = []  # spans of the text that a comment accounts for
        self.names = Names(newest=self.newest, median=statistics.median, mean=statistics.fmean)
        self.at = 0  # in the text, where the comment at hand belongs
        self.check()
        if self.name not in NOT_HELD:
            self.unaccounted()

    def error(self, at, words):
        self.errors.append((self.text.count("\n", 0, at) + 1, words))

    def block_before(self, at):
        """The paragraph or table that a comment at `at` is of, without other comments between."""
        end = len(self.text[:at].rstrip())
        while self.text[:end].endswith("-->"):
            end = len(self.text[: self.text.rindex("<!--", 0, end)].rstrip())
        start = max([0] + [m.end() for m in re.finditer(r"\n[ \t]*\n|-->[ \t]*\n", self.text[:end])])
        return start, end

    def section(self, at):
        """From heading to heading."""
        headings = [m.start() for m in re.finditer(r"^#+ ", FENCED.sub(blank, self.text), re.M)]
        start = max([0] + [h for h in headings if h < at])
        return self.text[start : min([len(self.text)] + [h for h in headings if h > at])]

    def told(self, name):
        if not re.search(rf"\b{re.escape(name)}\b", COMMENT.sub("", self.section(self.at)), re.I):
            raise Fault(f"the section does not say '{name}'")

    def take_run(self, words):
        experiment, profile, *machine = words.split()
        machine = " ".join(machine)
        found = self.runs.newest(profile, machine)
        if not machine or experiment not in found:
            raise Fault(f"results/reference has no run of {experiment} at the {profile} profile on '{machine}'")
        self.names.run = found[experiment]
        self.told(machine)
        self.told(experiment)

    def newest(self, profile, machine):
        self.told(machine)
        return list(self.runs.newest(profile, machine).values())

    def evaluated(self, expression):
        try:
            value = eval(expression, self.names)
        except (Fault, fill.Missing) as fault:
            raise Fault(str(fault)) from fault
        except Exception as fault:  # a wrong expression may do anything
            raise Fault(f"{expression}: {type(fault).__name__}: {fault}") from fault
        values = list(value) if isinstance(value, tuple | list) else [value]
        if not values or not all(isinstance(one, int | float) and math.isfinite(one) for one in values):
            raise Fault(f"{expression}: no number: {value}")
        return values

    def piece(self, piece, expression, block, at):
        """Checks one line; the place behind it in the text."""
        start, end = block
        if piece == "*":
            self.exempt(expression, "")
            self.covered.append(block)
            return start
        pattern = r"\s+".join(map(re.escape, piece.split()))
        before, behind = r"(?<![\w.,])" * piece[0].isdigit(), r"(?![\d]|[.,]\d)" * piece[-1].isdigit()
        match = re.compile(before + pattern + behind).search(self.text, start, end)
        if not match:
            raise Fault(f"'{piece}' does not stand above, or not in this order")
        self.covered.append(match.span())
        if expression in EXEMPT or (self.root / expression).is_file():
            self.exempt(expression, piece)
            return match.end()
        expression, how = re.fullmatch(r"(.*?)(?: as (%?\d?))?", expression).groups("")
        values, printed = self.evaluated(expression), list(PRINTED.finditer(self.text, *match.span()))
        self.count += 1 if isinstance(values[0], bool) else len(printed)
        if values[0] is True and len(values) == 1:
            return match.end()
        if values == [False]:
            self.error(match.start(), f"{piece}: the rows no longer bear it out: {expression}")
            return match.end()
        if len(printed) != len(values):
            raise Fault(f"{piece}: {len(printed)} numbers, but {len(values)} values: {expression}")
        for number, in_line, value in zip(printed, PRINTED.finditer(piece), values):
            right = as_printed(value, number[0], how)
            if right != number[0]:
                self.error(number.start(), f"{number[0]} ({' '.join(piece.split())}): the rows say {right}")
                self.edits += [(*number.span(), right), (at + in_line.start(), at + in_line.end(), right)]
        return match.end()

    def exempt(self, reason, piece):
        if reason == "once":
            self.told("measured once")
        elif reason not in EXEMPT:
            if not (self.root / reason).is_file():
                raise Fault(f"no reason: {reason}")
            told = (self.root / reason).read_text(encoding="utf-8")
            for number in re.findall(NUMBER, piece):
                if not re.search(rf"(?<![\w.]){re.escape(number)}(?![\w.])", told):
                    raise Fault(f"{reason} has no {number}")

    def check(self):
        for comment in COMMENT.finditer(self.text):
            start, end = self.block_before(comment.start())
            self.at, at = start, comment.start(1)
            for line in comment[1].splitlines():
                name = NAMED.fullmatch(line)
                key, colon, rest = line.partition(": ")
                try:
                    if name:
                        self.names[name[1]] = eval(f"lambda {name[2][1:-1]}: {name[3]}" if name[2] else name[3], self.names)
                    elif key == "rows":
                        self.take_run(rest)
                    elif colon:
                        start = self.piece(key, rest.strip(), (start, end), at)
                    else:
                        raise Fault(f"no 'text: expression': {line}")
                except (Fault, fill.Missing, SyntaxError, NameError) as fault:
                    self.error(at, str(fault))
                at += len(line) + 1

    def unaccounted(self):
        """Names the numbers of measurements that no comment accounts for."""
        prose = NO_PROSE.sub(blank, self.text)
        found = [match.span() for match in MEASURE.finditer(prose)]
        for table in re.finditer(r"^\|.*\n\|[-| :]+\|\n((?:\|.*\n?)+)", prose, re.M):
            columns = [i for i, cell in enumerate(table[0].split("\n")[0].split("|")) if COLUMN.search(cell)]
            at = table.start(1)
            for row in table[1].splitlines(keepends=True):
                edges = [m.start() for m in re.finditer(r"\|", row)]
                for i in columns:
                    if i < len(edges):
                        cell = slice(at + edges[i - 1] + 1, at + edges[i])
                        found += [m.span() for m in PRINTED.finditer(prose, cell.start, cell.stop)]
                at += len(row)
        numbers = set()
        for start, end in found:
            inner = [m.span() for m in PRINTED.finditer(prose, start, end)] or [(start, end)]
            numbers |= set(inner)
        for start, end in sorted(numbers):
            if not any(a <= start and end <= b for a, b in self.covered):
                around = " ".join(self.text[max(0, start - 30) : end + 20].split())
                self.error(start, f"no rows are named for '{self.text[start:end]}' in '...{around}...'")

    def write(self):
        for start, end, new in sorted(set(self.edits), reverse=True):
            self.text = self.text[:start] + new + self.text[end:]
        self.path.write_text(self.text, encoding="utf-8")


def pages(root):
    return [path for path in (root / "README.md", *sorted((root / "docs").glob("*.md"))) if path.exists()]


def check(root, write=False):
    """(errors, how many numbers and conditions were looked up, on how many pages)"""
    runs, errors, count, traced = Runs(root), [], 0, 0
    for path in pages(root):
        page = Page(path, root, runs)
        if write and page.edits:
            page.write()
            page = Page(path, root, runs)
        errors += [f"{page.name}:{line}: {words}" for line, words in sorted(set(page.errors))]
        count += page.count
        traced += page.count > 0
    return errors, count, traced


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--write", action="store_true")
    options.add_argument("root", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent)
    options = options.parse_args()
    errors, count, traced = check(options.root.resolve(), write=options.write)
    if errors or not count:
        sys.exit("\n".join(errors) or "no page names a row")
    print(f"{count} figures of {traced} pages are those of the rows")


if __name__ == "__main__":
    main()
