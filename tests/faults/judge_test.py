#!/usr/bin/env python3
"""The judge of faults can fail: it is shown cut files, mixed outputs and leftovers, and must name them."""
import json
import pathlib
import shutil
import struct
import sys
import tempfile
import unittest
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from cli_fixture import write_png
from decode import Cut, check_whole
from judge import Contents, Verdict, reference


def small_exr():
    """One channel of floats, 5 x 20: two blocks, packed by ZIP."""

    def attribute(name, kind, body):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(body)) + body

    window = struct.pack("<4i", 0, 0, 4, 19)
    header = b"\x76\x2f\x31\x01" + struct.pack("<I", 2)
    header += attribute(b"channels", b"chlist", b"R\0" + struct.pack("<IIii", 2, 0, 1, 1) + b"\0")
    header += attribute(b"compression", b"compression", b"\x03") + attribute(b"dataWindow", b"box2i", window) + b"\0"
    blocks = [struct.pack("<iI", y, len(packed)) + packed
              for y, rows in ((0, 16), (16, 4)) for packed in [zlib.compress(bytes(rows * 5 * 4))]]
    first = len(header) + 16
    return header + struct.pack("<2Q", first, first + len(blocks[0])) + b"".join(blocks)


class Decode(unittest.TestCase):
    def setUp(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-judge-"))
        self.addCleanup(shutil.rmtree, folder)
        write_png(folder / "a.png", 7, 5, bytes(range(105)))
        self.whole = {
            "a.png": (folder / "a.png").read_bytes(),
            "a.exr": small_exr(),
            "a.csv": b"a,b\n1,2\n",
            "a.json": b'{"a": [1, 2]}',
            "a.svg": b"<svg><g/></svg>",
            "a.md": b"| a |\n",
        }

    def test_whole_files_pass(self):
        for name, data in self.whole.items():
            check_whole(name, data)

    def test_a_cut_anywhere_is_found(self):
        for name, data in self.whole.items():
            for length in range(len(data)):
                if name in ("a.csv", "a.md") and data[:length].endswith(b"\n"):
                    continue  # whole rows that are missing show only beside a reference
                with self.assertRaises(Cut, msg=f"{name} cut to {length}"):
                    check_whole(name, data[:length])

    def test_damage_is_found(self):
        png, exr = self.whole["a.png"], self.whole["a.exr"]
        for name, data in (("a.png", png[:40] + bytes([png[40] ^ 1]) + png[41:]), ("a.png", png + b"x"),
                           ("a.exr", exr.replace(exr[-8:], bytes(8))), ("a.exr", exr + b"x"), ("a.csv", b"a,b\n1\n")):
            with self.assertRaises(Cut):
                check_whole(name, data)


class Judge(unittest.TestCase):
    def setUp(self):
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-judge-"))
        self.addCleanup(shutil.rmtree, self.place)
        self.empty = Contents(self.place)
        self.write_output("new")
        self.new = reference(self.place, self.empty)
        self.write_output("old")
        self.before = Contents(self.place)

    def write_output(self, text):
        (self.place / "out").mkdir(exist_ok=True)
        (self.place / "out/fit.json").write_text(json.dumps({"solver": text, "times_s": {"total_s": len(text)}}))
        (self.place / "out/map.bin").write_text(text)

    def verdict(self, before=None):
        return Verdict(self.place, before or self.before, [self.new])

    def assert_named(self, problems, *words):
        self.assertTrue(any(all(word in problem for word in words) for problem in problems), problems)

    def test_old_and_new_pass(self):
        self.assertEqual(self.verdict().after_kill(), [])
        self.assertEqual(self.verdict().after_failure(steps=False), [])
        self.write_output("new")
        self.assertEqual(self.verdict().after_kill(), [])
        self.assertEqual(self.verdict().after_success(), [])

    def test_times_may_differ_and_nothing_else(self):
        self.write_output("new")
        (self.place / "out/fit.json").write_text(json.dumps({"solver": "new", "times_s": {"total_s": 77}}))
        self.assertEqual(self.verdict().after_success(), [])
        (self.place / "out/fit.json").write_text(json.dumps({"solver": "news", "times_s": {}}))
        self.assert_named(self.verdict().after_success(), "out", "neither the old nor the new one", "fit.json")

    def test_a_mixture(self):
        (self.place / "out/map.bin").write_text("new")
        self.assert_named(self.verdict().after_kill(), "out", "neither", "fit.json")
        (self.place / "out/map.bin").unlink()
        self.assert_named(self.verdict().after_kill(), "map.bin (missing)")

    def test_a_cut_file(self):
        (self.place / "out/fit.json").write_text('{"solver": ')
        self.assert_named(self.verdict().after_kill(), "out", "stands there cut")

    def test_exit_0_with_the_old_output(self):
        self.assert_named(self.verdict().after_success(), "out is not the new one")

    def test_a_failed_run_that_replaced(self):
        self.write_output("new")
        self.assert_named(self.verdict().after_failure(steps=False), "out is the new one, though the run failed")
        self.assertEqual(self.verdict().after_failure(steps=True), [])
        self.assertTrue(self.verdict().all_new())

    def test_something_older_is_lost(self):
        shutil.rmtree(self.place / "out")
        self.assert_named(self.verdict().after_kill(), "out was there and is gone")
        self.assertEqual(self.verdict(self.empty).after_kill(), [])

    def test_leftovers(self):
        (self.place / ".tmp-1-2-out").mkdir()
        self.assertEqual(self.verdict().after_kill(), [])
        self.assert_named(self.verdict().after_failure(steps=False), "leftover .tmp-1-2-out")

    def test_files_that_nobody_writes(self):
        (self.place / "stray").write_text("")
        self.assert_named(self.verdict().after_kill(), "stray", "nobody writes it")


if __name__ == "__main__":
    unittest.main()
