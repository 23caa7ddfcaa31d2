#!/usr/bin/env python3
"""Every bad input that we know: the rows of bad_inputs/rows_*.py, each a command, what is wrong, and what must come.

    bad_inputs_test.py PROGRAM EXPERIMENTS SOURCE [TEXT...]

PROGRAM is radiafit, EXPERIMENTS the folder of the experiments' programs, SOURCE the checkout. With TEXTs only the rows
run that hold one of them. A row is

    ("fit tiny -o new", field("tiny/dataset.json", "views[0].gain", 0), 2, "views[0].gain", "must be above 0")

the command (an experiment's name begins one of its own, NAME=value sets a variable before it), the damage (None, one or
several of bad_inputs/damage.py), the exit status, and words that the answer holds. It runs in a folder of its own with
copies of the inputs that it names (bad_inputs/fixtures.py). Of every row that is refused is required: one line on
standard error, after the one that announces what a command needs; no control characters; an empty standard output; not
a file or folder made, changed or lost; an end within a minute; and no more than 200 MB of memory above that of the
accepted rows of the same command. A row that is accepted (status 0) may make what its -o and --records name, and nothing
else.
"""
import concurrent.futures
import importlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time

from bad_inputs import damage, fixtures
from cli_fixture import snapshot

HANGS_S = 60  # a row takes well below a second; a loaded machine may take several
MORE_MEMORY = 200 << 20
TABLES = ("options", "data", "captures", "stereo", "rti", "fits", "files", "experiments", "runs", "replace", "solve")
NOBODY = 65534
ANNOUNCEMENT = re.compile("(generate|import|depths|fit|solve) needs about |chosen by the data: ")  # before the work


class Row:
    def __init__(self, table, command, damages, status, *words):
        self.table, self.command, self.status, self.words = table, command, status, words
        self.damages = [] if damages is None else damages if isinstance(damages, (list, tuple)) else [damages]
        self.arguments = shlex.split(command)
        self.environment = {}
        while self.arguments and re.match("[A-Z_]+=", self.arguments[0]):
            name, _, value = self.arguments.pop(0).partition("=")
            self.environment[name] = value
        if not isinstance(status, int) or (status and not words):
            raise SystemExit(f"rows_{table}.py: {command!r}: a row is (command, damage, status, word...)")

    def __str__(self):
        return f"[{self.table}] {self.command!r}" + "".join(f", {d}" for d in self.damages)

    def inputs(self, known):
        """The fixtures that the command or a damage names, and what they need."""
        texts = [a for argument in self.arguments for a in argument.split("=")] + [d.path for d in self.damages]
        texts += [d.source for d in self.damages]
        return fixtures.closure(known.intersection(t.split("/")[0] for t in texts))

    def outputs(self):
        pairs = zip(self.arguments, self.arguments[1:])
        return [value for option, value in pairs if option in ("-o", "--output", "--records")]


class Answer:
    """What came of a program: status (below 0: a signal), both outputs, peak memory in bytes, seconds."""

    def __init__(self, arguments, folder, environment, unprivileged):
        user = {"user": NOBODY, "group": NOBODY} if unprivileged and os.geteuid() == 0 else {}
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            start = time.monotonic()
            process = subprocess.Popen(
                arguments, cwd=folder, env={**os.environ, **environment}, stdin=subprocess.DEVNULL, stdout=out, stderr=err, **user
            )
            timer = threading.Timer(HANGS_S, process.kill)
            timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = self.status = os.waitstatus_to_exitcode(status)
            self.seconds = time.monotonic() - start
            self.memory = usage.ru_maxrss << 10
            out.seek(0), err.seek(0)
            self.output, self.error = out.read(), err.read()

    def complaints(self, row):
        if self.seconds >= HANGS_S:
            yield f"hung: killed after {HANGS_S} s"
        if self.status != row.status:
            yield f"status {self.status}, not {row.status}"
        text = (self.error if row.status else self.output + self.error).decode("utf-8", "replace")
        for word in row.words:
            if word not in text:
                yield f"{word!r} is not said"
        if row.status:
            if self.output:
                yield f"standard output holds {self.output[:200]!r}"
            refusal = [line for line in text.splitlines() if not ANNOUNCEMENT.match(line)]
            if len(refusal) != 1 or not text.endswith("\n"):
                yield "not one line on standard error"
        if any(c < 32 and c != 10 for c in self.error) or "\ufffd" in text:
            yield "control characters on standard error"


class Runner:
    def __init__(self, program, experiments, source, root):
        self.program, self.experiments, self.source = program, experiments, source
        self.goods, self.root = root / "goods", root
        self.goods.mkdir()

    def prepare(self):
        def run(*arguments):
            made = subprocess.run([self.program, *arguments], cwd=self.goods, capture_output=True, text=True)
            if made.returncode:
                raise SystemExit(f"{' '.join(arguments)}: status {made.returncode}: {made.stderr}")

        fixtures.make(run, self.goods, self.source)
        self.known = {path.name for path in self.goods.iterdir()}

    def arguments(self, row):
        own = self.experiments / row.arguments[0] if row.arguments else None
        return [own, *row.arguments[1:]] if own and own.is_file() else [self.program, *row.arguments]

    def run(self, number, row):
        """The row's answer and what is wrong with it."""
        folder = self.root / f"row{number}"
        folder.mkdir()
        for name in row.inputs(self.known):
            shutil.copytree(self.goods / name, folder / name)
        for d in row.damages:
            d.apply(folder)
        before = snapshot(folder)
        unprivileged = any(d.unprivileged for d in row.damages)
        if unprivileged:
            folder.chmod(0o777)
        answer = Answer(self.arguments(row), folder, row.environment, unprivileged)
        wrong = list(answer.complaints(row))
        after = snapshot(folder)
        allowed = row.outputs() if row.status == 0 else []
        for path in sorted(before.keys() | after.keys()):
            if before.get(path) != after.get(path) and not any(path.startswith(a.rstrip("/")) for a in allowed):
                wrong.append(f"{path} was {'made' if path not in before else 'changed' if path in after else 'lost'}")
        shutil.rmtree(folder)
        return answer, wrong

    def run_all(self, rows):
        workers = os.cpu_count() or 1
        with concurrent.futures.ThreadPoolExecutor(workers) as pool:
            answers = list(pool.map(self.run, range(len(rows)), rows))
        allowed = {}  # peak memory of the accepted rows, by command
        for row, (answer, _) in zip(rows, answers):
            if row.status == 0:
                allowed[row.arguments[0]] = max(allowed.get(row.arguments[0], 0), answer.memory)
        failures = 0
        for row, (answer, wrong) in zip(rows, answers):
            limit = allowed.get(row.arguments[0] if row.arguments else "", min(allowed.values(), default=0)) + MORE_MEMORY
            if row.status and allowed and answer.memory > limit and "ASAN_OPTIONS" not in os.environ:
                wrong.append(f"took {answer.memory >> 20} MB, where {limit >> 20} are allowed")
            if wrong:
                failures += 1
                print(f"FAILED {row}\n  {'; '.join(wrong)}\n  it said: {(answer.error or answer.output)[:600]!r}")
        return failures


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    program, experiments, source = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
    rows = []
    for table in TABLES:
        rows += [Row(table, *row) for row in importlib.import_module(f"bad_inputs.rows_{table}").rows]
    seen = set()
    for row in rows:
        if str(row) in seen:
            sys.exit(f"{row} stands in the table twice")
        seen.add(str(row))
    chosen = [row for row in rows if not sys.argv[4:] or any(text in str(row) for text in sys.argv[4:])]
    with tempfile.TemporaryDirectory(prefix="radiafit-bad-inputs-") as root:
        os.chmod(root, 0o755)  # for rows that run as nobody
        runner = Runner(program, experiments, source, pathlib.Path(root))
        runner.prepare()
        start = time.monotonic()
        failures = runner.run_all(chosen)
    accepted = sum(row.status == 0 for row in chosen)
    print(f"{len(chosen)} rows ({accepted} accepted), {failures} failed, {time.monotonic() - start:.0f} s")
    sys.exit(1 if failures or not chosen else 0)


if __name__ == "__main__":
    main()
