#!/usr/bin/env python3
"""`solve` over many problems: in blocks, in shards, stopped and begun again, it ends in the same bits; and each of its
optimizers finds the minimum that an independent least-squares formula gives. Arguments: the program."""
import array
import json
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

from cli_fixture import ProgramTest, take_arguments

LINE = """struct Terms { real t; };
struct Parameters { real slope, offset; };
struct Values { real y; };
Values value(Parameters p, Terms t) { return Values(p.slope * t.t + p.offset); }
"""
SAMPLES = 6
START = ("--start", "slope=0,offset=0")


def save(path, shape, numbers):
    """As numpy.save writes an array of doubles."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {tuple(shape)}, }}"
    header += " " * (-(len(header) + 11) % 64) + "\n"
    path.write_bytes(b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little") + header.encode() + array.array("d", numbers).tobytes())


def load(path):
    data = path.read_bytes()
    begin = 10 + int.from_bytes(data[8:10], "little")
    kind = {"<f8": "d", "<f4": "f", "<i4": "i", "<i8": "q"}[data[10:begin].decode().split("'descr': '")[1][:3]]
    return array.array(kind, data[begin:])


class Solve(ProgramTest):
    def setUp(self):
        for path in self.root.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        (self.root / "line.glsl").write_text(LINE)
        self.problems("in", 20000)

    def problems(self, name, count, seed=1):
        """Straight lines with noise; of each their own samples' places."""
        folder = self.root / name
        folder.mkdir(exist_ok=True)
        draw = random.Random(seed)
        self.terms = [draw.uniform(-1, 3) for _ in range(count * SAMPLES)]
        self.targets = [2 * t + 1 + draw.gauss(0, 0.3) for t in self.terms]
        save(folder / "terms.npy", (count, SAMPLES, 1), self.terms)
        save(folder / "targets.npy", (count, SAMPLES, 1), self.targets)

    def arrays(self, name):
        return {path.name: path.read_bytes() for path in sorted((self.root / name).glob("*.npy"))}

    def solve(self, *more, out):
        return self.good("solve", "in", "--model", "line.glsl", *START, *more, "-o", out)

    def test_optimizers_find_what_the_normal_equations_say(self):
        self.problems("in", 50)
        expected = []
        for k in range(50):
            t, y = (x[k * SAMPLES : (k + 1) * SAMPLES] for x in (self.terms, self.targets))
            mean_t, mean_y = sum(t) / SAMPLES, sum(y) / SAMPLES
            slope = sum((a - mean_t) * (b - mean_y) for a, b in zip(t, y)) / sum((a - mean_t) ** 2 for a in t)
            expected += [slope, mean_y - slope * mean_t]
        for optimizer in ("lm", "cg", "lbfgs", "adam"):
            with self.subTest(optimizer):
                self.solve("--optimizer", optimizer, "--tolerance", "1e-4", "--iterations", "20000", out=optimizer)
                for found, wanted in zip(load(self.root / optimizer / "parameters.npy"), expected):
                    self.assertAlmostEqual(found, wanted, delta=1e-4)
        self.refused("solve", "in", "--model", "line.glsl", *START, "--learning-rate", "0.1", "-o", "none",
                     says=["--learning-rate is of --optimizer adam"])

    def test_blocks_and_shards_give_the_same_bits(self):
        self.solve(out="whole")
        self.solve("--memory", "1M", out="blocks")
        self.assertEqual(self.arrays("whole"), self.arrays("blocks"))
        for i in (1, 2, 3):
            self.solve("--shard", f"{i}/3", out=f"shard{i}")
        self.good("merge", "shard2", "shard3", "shard1", "-o", "merged")
        self.assertEqual(self.arrays("whole"), self.arrays("merged"))
        whole, merged = (json.loads((self.root / name / "solution.json").read_text()) for name in ("whole", "merged"))
        for entry in ("model", "parameters", "statuses", "arrays"):
            self.assertEqual(whole[entry], merged[entry], entry)
        self.assertNotIn("shard", merged)

        self.refused("merge", "shard1", "shard3", "-o", "none", says=["of 3 shards 2 is missing"])
        self.refused("merge", "shard1", "shard2", "shard3", "shard2", "-o", "none", says=["both are shard 2 of 3"])
        self.refused("merge", "shard1", "whole", "-o", "none", says=["whole: a whole solution"])
        self.solve("--fix", "offset", "--shard", "3/3", out="foreign")
        self.refused("merge", "shard1", "shard2", "foreign", "-o", "none", says=["foreign: a shard of another fit"])
        self.refused("solve", "in", "--model", "line.glsl", *START, "--shard", "1/30000", "-o", "none",
                     says=["--shard 1/30000: there are 20000 problems"])
        self.refused("merge", "shard1", "nowhere", "-o", "none", says=["nowhere: missing"])
        described = self.root / "shard3/solution.json"
        text = described.read_text()
        for old, new in (('"shard": [\n    3,\n    3', '"shard": [\n    3,\n    0'), ('"shard": [\n    3,\n    3', '"shard": [\n    3,\n    -5'),
                         ('"shard": [\n    3,\n    3', '"shard": [\n    1e300,\n    3'), ('"version": 1', '"version": 2'),
                         ('"<f8"', '"<f4"'), ('"converged": ', '"converged": -'), ('"converged": ', '"converged": 1'),
                         ('"table": false', '"table": true'), (text, "{"), (text, "[]")):  # fmt: skip
            with self.subTest(new):
                self.assertIn(old, text)
                described.write_text(text.replace(old, new))
                self.refused("merge", "shard1", "shard2", "shard3", "-o", "none", says=["shard3"])
        described.write_text(text.replace('"shard": [\n    3,\n    3', '"shard": [\n    3,\n    2000000000'))
        self.refused("merge", "shard3", "-o", "none", says=["of 2000000000 shards 1, 2, 4, ", " and more are missing"])
        described.write_text(text)
        damaged = self.root / "shard3/sigma.npy"
        damaged.write_bytes(damaged.read_bytes()[:-8])
        self.refused("merge", "shard1", "shard2", "shard3", "-o", "none", says=["shard3/sigma.npy: cut"])

    def test_a_table_in_shards(self):
        rows = [f"p{i % 7},{i},{3 * i + i % 3}" for i in range(70)]
        (self.root / "table.csv").write_text("problem,t,y\n" + "\n".join(rows) + "\n")
        table = ("solve", "table.csv", "--model", "line.glsl", *START)
        self.good(*table, "-o", "whole")
        for i in (1, 2):
            self.good(*table, "--shard", f"{i}/2", "-o", f"shard{i}")
        self.good("merge", "shard1", "shard2", "-o", "merged")
        self.assertEqual(self.arrays("whole"), self.arrays("merged"))
        self.assertEqual(*((self.root / name / "solution.csv").read_text() for name in ("whole", "merged")))

    def stopped(self, number, *more):
        """Sends a signal once problems are kept. Returns what was said last; None: it was faster."""
        process = subprocess.Popen([str(self.program), "solve", "in", "--model", "line.glsl", *START, *more, "--checkpoint",
                                    "0.000001", "-o", "out"], cwd=self.root, stderr=subprocess.PIPE, text=True,
                                   stdout=subprocess.DEVNULL)  # fmt: skip
        kept = self.root / "out.parts/solution.journal"
        while process.poll() is None and not (kept.exists() and kept.stat().st_size > 100_000):
            time.sleep(0.0005)
        process.send_signal(number)
        said = process.communicate()[1]
        return said if process.returncode else None

    def test_stopped_and_begun_again(self):
        self.problems("in", 200_000)
        more = ("--optimizer", "cg", "--memory", "4M")
        self.solve(*more, out="whole")
        for _ in range(20):
            if said := self.stopped(signal.SIGINT, *more):
                break
            shutil.rmtree(self.root / "out")
        else:
            self.fail("the solution was faster than the signal, twenty times")
        self.assertIn("out.parts keeps what is finished", said.splitlines()[-1])
        self.assertFalse((self.root / "out").exists())
        self.refused("solve", "in", "--model", "line.glsl", *START, "--resume", "-o", "out",
                     says=["out.parts: holds parts of another fit: ", "--optimizer is 'cg' there, 'lm' here"])
        for other, says in ((("--optimizer", "cg", "--memory", "2M"), "--memory is '4M' there, '2M' here"),
                            ((*more, "--shard", "2/2"), "--shard is '' there, '2/2' here")):
            self.refused("solve", "in", "--model", "line.glsl", *START, *other, "--resume", "-o", "out", says=[says])
        again = self.solve(*more, "--resume", out="out")
        self.assertIn("out.parts: goes on from there", again.stderr)
        self.assertEqual(self.arrays("whole"), self.arrays("out"))
        self.assertFalse((self.root / "out.parts").exists())

    def test_counts_that_no_file_holds(self):
        folder = self.root / "empty"
        folder.mkdir()
        save(folder / "terms.npy", (0, 1), [])
        for count, says in ((2**60, "problems, more than any disk holds"), (2**50, "of disk for none")):
            save(folder / "targets.npy", (count, 0), [])
            self.refused("solve", "empty", "--model", "line.glsl", *START, "-o", "none", says=[says])
        save(folder / "targets.npy", (0, 3), [])
        save(folder / "terms.npy", (0, 3, 1), [])
        self.refused("solve", "empty", "--model", "line.glsl", *START, "--lower", "slope=2", "--upper", "slope=1", "-o", "none",
                     says=["bounds of slope: from 2 to 1"])
        self.assertIn("0 problems in 0 s\n", self.good("solve", "empty", "--model", "line.glsl", *START, "-o", "none").stdout)

    def test_what_a_killed_run_left_beside_a_finished_solution(self):
        self.problems("in", 50)
        self.solve(out="out")
        left = self.root / "out.parts/shard-1"
        left.mkdir(parents=True)
        for age, stays in ((3600, False), (-3600, True)):
            left.mkdir(parents=True, exist_ok=True)
            (left / "part-1.bin").write_text("finished")
            for path in (left / "part-1.bin", left, left.parent):
                os.utime(path, (time.time() - age,) * 2)
            self.assertIn("done already", self.solve(out="out").stderr)
            self.assertEqual(left.exists(), stays)

    def test_what_is_wrong_in_the_last_block_shows_before_the_first_is_solved(self):
        self.problems("in", 3000)
        save(self.root / "in/start.npy", (3000, 2), [0.0] * 5998 + [float("nan"), 0.0])
        self.refused("solve", "in", "--model", "line.glsl", "--memory", "100K", "-o", "none",
                     says=["starts: slope of problem 2999 is no finite number"])


if __name__ == "__main__":
    program, = take_arguments(1)
    Solve.program = program
    unittest.main()
