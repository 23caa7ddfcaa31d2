#!/usr/bin/env python3
"""Fits in parts: by --memory, by shards that are merged, and by mpirun. All come to what one fit comes to, byte by byte.

Arguments: the program.
"""
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

from cli_fixture import ProgramTest, snapshot, take_arguments

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "faults"))
from judge import content

FIT = ("--terms", "2", "--iterations", "4")


class PartsTest(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")
        cls.good("fit", "star", *FIT, "-o", "whole")
        cls.flat_sample("flat", size=24, noise=(3,))

    def setUp(self):
        for path in self.root.iterdir():
            if path.name not in ("star", "ornament", "whole", "flat-set"):
                shutil.rmtree(path) if path.is_dir() else path.unlink()

    def maps(self, fit):
        """Digests of everything but the records of when and how."""
        return {name: digest for name, digest in snapshot(self.root / fit).items()
                if name.endswith((".exr", ".ply"))}  # fmt: skip

    def shards(self, count, *options, dataset="star", prefix="shard"):
        for i in range(1, count + 1):
            self.good("fit", dataset, *options, "--shard", f"{i}/{count}", "-o", f"{prefix}-{i}")
        return [f"{prefix}-{i}" for i in range(1, count + 1)]


class Parts(PartsTest):
    def merged_like_whole(self, dataset, *options, exact=True, shards=3):
        with self.subTest(dataset=dataset, options=options):
            self.setUp()
            self.good("fit", dataset, *options, "-o", "one")
            self.good("merge", *self.shards(shards, *options, dataset=dataset), "-o", "merged")
            one, merged = self.maps("one"), self.maps("merged")
            self.assertGreaterEqual(len(one), 2)
            self.assertEqual(one.keys(), merged.keys())
            if exact:  # all that a judge reads, and errors by iteration
                self.assertEqual(*(content(self.root / fit, False) for fit in ("one", "merged")))
                return
            scores = [json.loads(self.good("judge", fit, "--json").stdout)["psnr"] for fit in ("one", "merged")]
            self.assertAlmostEqual(*scores, delta=1e-4)
            tables = [[line.split(",") for line in (self.root / fit / "trace.csv").read_text().splitlines()[1:]]
                      for fit in ("one", "merged")]  # fmt: skip
            for before, after in zip(*tables, strict=True):
                self.assertEqual(before[2], after[2])
                self.assertAlmostEqual(float(before[4]), float(after[4]), delta=1e-5 * float(before[4]))

    def test_every_solver_of_light_field_maps(self):
        for options in (
            FIT,
            (*FIT, "--surface", "linear"),
            (*FIT, "--deflate"),
            (*FIT, "--texels-per-pixel", "1"),
            (*FIT, "--validation", "4"),
            (*FIT, "--loss", "cauchy", "--weights", "facing"),
            (*FIT, "--optimizer", "lbfgs"),
            (*FIT, "--solver", "two-step"),
            (*FIT, "--solver", "two-step", "--record", "full"),
            (*FIT, "--distributor", "gl"),
            ("--solver", "als", "--iterations", "2"),
            ("--solver", "varpro", "--iterations", "1"),
            ("--solver", "ceres", "--iterations", "2"),
            ("--solver", "pca", "--terms", "2", "--refills", "2"),
            ("--solver", "mean"),
            ("--solver", "mean", "--surface", "linear"),
            ("--solver", "als", "--iterations", "2", "--surface", "linear"),
            (*FIT, "--solver", "two-step", "--surface", "linear"),
            (*FIT, "--engine", "compute", "--surface", "linear"),
            (*FIT, "--engine", "compute"),
            (*FIT, "--engine", "compute", "--accumulate", "scatter-fixed"),
            (*FIT, "--engine", "compute", "--samples", "redistributed"),
            ("--terms", "1", "--iterations", "2", "--engine", "fragment", "--passes", "paper"),
        ):
            # Each shard's size has llvmpipe compile shaders of its own.
            self.merged_like_whole("star", *options, shards=2 if "--engine" in options else 3)
        # images are summed in batches, and a part leaves some images out
        self.merged_like_whole("star", "--terms", "1", "--iterations", "2", "--engine", "fragment", exact=False, shards=2)

    def test_every_solver_of_texel_local_models(self):
        for options in (
            ("--model", "lambert"),
            ("--model", "ptm"),
            ("--model", "lafortune", "--iterations", "4", "--shadow-below", "0.2", "--prior", "none"),
            ("--model", "lafortune", "--iterations", "4", "--solver", "tinysolver"),
            ("--model", "lafortune", "--iterations", "4", "--optimizer", "cg"),
            ("--model", "lafortune", "--iterations", "3", "--optimizer", "cg", "--engine", "compute"),
            ("--model", "lafortune", "--iterations", "1", "--optimizer", "cg", "--engine", "fragment"),
        ):
            self.merged_like_whole("ornament", *options)

    def test_texels_know_the_whole_surface(self):
        few = ("--model", "lafortune", "--iterations", "4", "--clip-above", "0.2", "--shadow-below", "0.3")
        for options in (few, (*few, "--validation", "3"), (*few, "--solver", "two-step")):
            self.merged_like_whole("ornament", *options)
            self.good("fit", "ornament", *options, "--prior", "none", "-o", "alone")
            self.assertNotEqual(self.maps("one"), self.maps("alone"))
        self.merged_like_whole("flat-set", "--model", "ptm")  # a grid of which all texels have few samples
        self.good("fit", "ornament", *few, "--replace", "-o", "one")
        done = self.good("fit", "ornament", *few, "--memory", "147M", "-o", "bounded")
        self.assertRegex(done.stderr, "part 2 of [2-9]")
        self.assertEqual(self.maps("one"), self.maps("bounded"))

    def test_colours_by_view_direction(self):
        for options in (
            ("--model", "viewbasis", "--blocks", "4", "--surface-side", "6"),
            ("--model", "viewbasis", "--rank", "4", "--blocks", "1", "--surface-side", "5", "--space", "linear"),
            ("--model", "viewbasis", "--rank", "28", "--blocks", "3", "--surface-side", "4", "--validation", "4", "--noise", "2e-3"),
            ("--model", "viewbasis", "--rank", "6", "--blocks", "4", "--surface-side", "5", "--engine", "compute"),
            ("--model", "sg", "--surface-side", "5"),
            ("--model", "sg", "--lobes", "2", "--iterations", "3", "--surface-side", "6", "--validation", "4"),
        ):
            self.merged_like_whole("star", *options)

    def test_memory_cuts_a_view_basis(self):
        options = ("star", "--rank", "2", "--blocks", "2", "--surface-side", "40")  # chosen by the data, in parts as well
        self.good("fit", *options, "-o", "one")
        done = self.good("fit", *options, "--memory", "165M", "-o", "bounded")
        self.assertRegex(done.stderr, "part 2 of [2-9]")
        self.assertEqual(self.maps("one"), self.maps("bounded"))
        planned = self.good("plan", *options, "--memory", "165M").stdout
        self.assertRegex(planned, r"in [2-9] parts, .* while learning, .* for a part")
        self.refused("fit", *options, "--memory", "151M", "-o", "none", says=["too little", "--memory"])

    def test_parts_share_a_light_basis(self):
        self.merged_like_whole("flat-set", "--model", "lightbasis", "--numbers", "7", "--blocks", "3")
        self.merged_like_whole("ornament", "--model", "lightbasis", "--numbers", "7", shards=2)  # each learns it, for seconds

    def test_memory_cuts_a_fit_and_resumes_it(self):
        fit = ("fit", "star", *FIT, "--engine", "compute")  # which holds vectors of all vertices
        done = self.good(*fit, "--memory", "149M", "-o", "bounded")
        self.assertRegex(done.stderr, "part 2 of [2-9]")
        self.assertFalse((self.root / "bounded.parts").exists())
        self.good(*fit, "--memory", "4G", "-o", "roomy")
        self.assertEqual(self.maps("roomy"), self.maps("bounded"))
        self.good("fit", "star", *FIT, "--memory", "4G", "-o", "small")
        self.assertEqual(self.maps("whole"), self.maps("small"))
        self.refused("fit", "star", *FIT, "--memory", "100M", "-o", "none", says=["too little", "--memory"])
        self.refused("fit", "star", *FIT, "--memory", "much", "-o", "none", says=["memory 'much'", "2G"])

    def test_a_shard_that_is_there_is_left_alone(self):
        self.good("fit", "star", *FIT, "--shard", "2/3", "-o", "shard")
        before = {path: path.stat().st_mtime_ns for path in (self.root / "shard").iterdir()}
        again = self.good("fit", "star", *FIT, "--shard", "2/3", "-o", "shard")
        self.assertIn("shard 2 of 3 is there", again.stderr)
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in (self.root / "shard").iterdir()})
        for other in ((*FIT, "--shard", "1/3"), ("--terms", "1", "--iterations", "4", "--shard", "2/3")):
            self.refused("fit", "star", *other, "-o", "shard", says=["shard", "choose another folder"])
        (self.root / "mine").mkdir()
        (self.root / "mine/letter.txt").write_text("dear")
        self.refused("fit", "star", *FIT, "--shard", "2/3", "-o", "mine", says=["letter.txt", "choose another folder"])

    def test_shards_that_do_not_belong_together(self):
        shards = self.shards(3, *FIT)
        self.good("merge", *reversed(shards), "-o", "merged")
        self.assertEqual(self.maps("whole"), self.maps("merged"))
        self.refused("merge", shards[0], shards[2], "-o", "none", says=["of 3 shards 2 is missing"])
        self.refused("merge", *shards, shards[1], "-o", "none", says=["both are shard 2 of 3"])
        self.good("fit", "star", "--terms", "2", "--iterations", "5", "--shard", "3/3", "-o", "foreign")
        self.refused("merge", *shards[:2], "foreign", "-o", "none", says=["foreign: a shard of another fit"])
        self.good("fit", "star", *FIT, "--shard", "3/4", "-o", "of-four")
        self.refused("merge", *shards[:2], "of-four", "-o", "none", says=["of-four", "others are of 3"])
        self.refused("merge", "star", "-o", "none", says=["star: no shard"])
        self.refused("merge", "nowhere", "-o", "none", says=["nowhere: missing"])
        self.refused("fit", "star", *FIT, "--shard", "4/3", "-o", "none", says=["shard '4/3'", "2/7"])
        self.refused("fit", "star", *FIT, "--shard", "3", "-o", "none", says=["shard '3'", "2/7"])

    def test_damaged_shards(self):
        shards = self.shards(2, *FIT)
        part = next((self.root / shards[1]).glob("part-*.bin"))
        whole = part.read_bytes()
        for damaged in (b"", whole[:7], whole[:1000], whole[:-1], whole + b"x", whole[:5000] + b"\1" + whole[5001:]):
            part.write_bytes(damaged)
            self.refused("merge", *shards, "-o", "none", says=[part.name, "damaged; delete it"])
        part.unlink()
        self.refused("merge", *shards, "-o", "none", says=[part.name, "missing"])
        note = self.root / shards[1] / "shard.json"
        for text in ("", "{", "[" * 200_000, '{"format": "radiafit-shard", "version": 1}'):
            note.write_text(text)
            self.refused("merge", *shards, "-o", "none", says=["shard.json: damaged"])
        note.unlink()
        self.refused("merge", *shards, "-o", "none", says=["no shard"])
        part.write_bytes(whole)
        self.refused("merge", *shards, "-o", "none", says=["isn't finished; run its command again"])
        again = self.good("fit", "star", *FIT, "--shard", "2/2", "-o", shards[1])
        self.assertIn("part 1 of 1 is there", again.stderr)
        self.good("merge", *shards, "-o", "merged")
        self.assertEqual(self.maps("whole"), self.maps("merged"))

    def test_a_shard_that_is_killed_goes_on(self):
        fit = ("fit", "star", "--terms", "2", "--iterations", "40", "--engine", "compute")
        killed = (*fit, "--memory", "149M", "-o", "killed")
        process = subprocess.Popen([str(self.program), *killed], cwd=self.root, stderr=subprocess.DEVNULL)
        parts = self.root / "killed.parts"
        while process.poll() is None and not list(parts.glob("part-*.bin")):
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
        process.wait()
        if (self.root / "killed/fit.json").exists():
            self.skipTest("the fit was faster than the signal")
        there = {path.name: path.stat().st_mtime_ns for path in parts.glob("part-*.bin")}
        self.assertTrue(there)
        again = self.good(*killed)
        self.assertIn("is there", again.stderr)
        self.good(*fit, "-o", "one")
        self.assertEqual(self.maps("one"), self.maps("killed"))
        self.assertFalse(parts.exists())

    def test_a_full_disk_leaves_no_half_part(self):
        limit = 40_000
        result = self.run_program("fit", "star", *FIT, "--shard", "1/2", "-o", "full", preexec_fn=lambda: (
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        ))  # fmt: skip
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("cannot write", result.stderr)
        self.assertEqual([], [path for path in (self.root / "full").rglob("*") if not path.name.startswith(".")])


@unittest.skipUnless(shutil.which("mpirun"), "no mpirun here")
class Ranks(PartsTest):
    MPIRUN = ("mpirun", "--allow-run-as-root", "--oversubscribe", "-n")

    def mpirun(self, count, *arguments):
        return subprocess.run(
            [*self.MPIRUN, str(count), str(self.program), *arguments],
            cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True, text=True,
        )  # fmt: skip

    def test_ranks_fit_like_one(self):
        for count in (1, 3):
            done = self.mpirun(count, "fit", "star", *FIT, "-o", f"ranks-{count}")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(self.maps("whole"), self.maps(f"ranks-{count}"))
            self.assertFalse((self.root / f"ranks-{count}.parts").exists())
            again = self.mpirun(count, "fit", "star", *FIT, "-o", f"ranks-{count}")
            self.assertEqual((again.returncode, again.stderr.count("done already")), (0, 1), again.stderr)
            other = self.mpirun(count, "fit", "star", "--terms", "1", "-o", f"ranks-{count}")
            self.assertEqual((other.returncode, other.stderr.count("is there already")), (2, 1), other.stderr)
            self.assertEqual(self.maps("whole"), self.maps(f"ranks-{count}"))

    def test_ranks_share_a_view_basis(self):
        fit = ("fit", "star", "--model", "viewbasis", "--rank", "4", "--blocks", "5", "--surface-side", "6")
        self.good(*fit, "-o", "one")
        done = self.mpirun(2, *fit, "-o", "ranks")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.maps("one"), self.maps("ranks"))

    def test_ranks_know_the_whole_surface(self):
        fit = ("fit", "ornament", "--model", "lafortune", "--iterations", "4", "--clip-above", "0.2")
        self.good(*fit, "-o", "one")
        done = self.mpirun(2, *fit, "-o", "ranks")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.maps("one"), self.maps("ranks"))

    def test_results_come_to_rank_0_where_it_has_no_disk_in_common(self):
        # each rank in a folder of its own, as on machines without a common disk
        script = f'cd "rank-$OMPI_COMM_WORLD_RANK" && exec "{self.program}" "$@"'
        for rank in range(3):
            (self.root / f"rank-{rank}").mkdir()
        done = subprocess.run(
            [*self.MPIRUN, "3", "sh", "-c", script, "sh", "fit", str(self.root / "star"), *FIT, "-o", "fit"],
            cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True, text=True,
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.maps("whole"), self.maps("rank-0/fit"))
        self.assertFalse((self.root / "rank-1/fit").exists())
        again = subprocess.run(done.args, cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
        self.assertEqual((again.returncode, again.stderr.count("done already")), (0, 1), again.stderr)

    def test_a_mistake_ends_all_ranks(self):
        done = self.mpirun(3, "fit", "star", "--memory", "100M", "-o", "none")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("too little", done.stderr)
        self.assertFalse((self.root / "none").exists())

    def test_a_rank_that_is_killed_leaves_nothing_half(self):
        options = ("--terms", "2", "--iterations", "400")
        fit = ("fit", "star", *options, "-o", "killed")
        process = subprocess.Popen([*self.MPIRUN, "3", str(self.program), *fit], cwd=self.root,
                                   stderr=subprocess.PIPE, text=True, start_new_session=True)  # fmt: skip
        deadline = time.monotonic() + 60
        ranks = []
        while len(ranks) < 3 and time.monotonic() < deadline and process.poll() is None:
            ranks = [int(p.name) for p in pathlib.Path("/proc").glob("[0-9]*") if self.is_rank(p, process.pid)]
            time.sleep(0.01)
        self.assertEqual(len(ranks), 3)
        os.kill(ranks[-1], signal.SIGKILL)
        while time.monotonic() < deadline and any(self.is_rank(pathlib.Path(f"/proc/{rank}"), process.pid) for rank in ranks):
            time.sleep(0.01)
        try:
            told = process.communicate(timeout=20)[1]
        except subprocess.TimeoutExpired:  # Open MPI 4.1 hangs now and then when it has ended all ranks
            os.killpg(process.pid, signal.SIGKILL)
            told = process.communicate()[1]
        self.assertNotEqual(process.returncode, 0)
        for rank in ranks:
            self.assertFalse(self.is_rank(pathlib.Path(f"/proc/{rank}"), process.pid), "a rank runs on")
        self.assertTrue("signal 9" in told or process.returncode == -signal.SIGKILL, told)
        self.assertFalse((self.root / "killed").exists())
        again = self.mpirun(3, *fit)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.good("fit", "star", *options, "-o", "one")
        self.assertEqual(self.maps("one"), self.maps("killed"))

    def is_rank(self, process, parent):
        try:
            command = (process / "cmdline").read_bytes().split(b"\0")[0].decode()
            return pathlib.Path(command) == self.program and f"PPid:\t{parent}\n" in (process / "status").read_text()
        except OSError:
            return False


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
