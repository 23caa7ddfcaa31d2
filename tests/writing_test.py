#!/usr/bin/env python3
"""What `radiafit` does when something takes no more: its disk, its terminal, the program that reads it. A file-size limit is
the full disk that a test can make.

Arguments: the program, and an experiment.
"""
import os
import resource
import shutil
import signal
import subprocess
import unittest

from cli_fixture import ProgramTest, complaints, snapshot, take_arguments, write_capture

EXPERIMENT = None
DEAD = 2**22 + 1  # above any process's number


class Writing(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")
        cls.good("fit", "star", "--iterations", "1", "-o", "fit")
        cls.good("fit", "ornament", "--model", "lambert", "-o", "lambert")
        write_capture(cls.root / "star", cls.root / "capture")

    def folder(self, name):
        """A folder for one test, that goes again."""
        path = self.root / name
        path.mkdir()
        self.addCleanup(shutil.rmtree, path)
        return path

    def started(self, *arguments, program=None, prepare=None, **streams):
        return subprocess.run([str(program or self.program), *map(str, arguments)], cwd=self.root, stdin=subprocess.DEVNULL,
                              text=True, preexec_fn=prepare, **streams)  # fmt: skip


class StandardStreams(Writing):
    def test_messages_that_nobody_takes_cost_no_result(self):
        place = self.folder("quiet")
        with open("/dev/full", "w") as full:
            for prepare in (None, lambda: os.close(2)):
                result = self.started("fit", "star", "--iterations", "1", "--replace", "-o", place / "fit", stderr=full, prepare=prepare)
                self.assertEqual(result.returncode, 0)
                self.assertEqual(sorted(p.name for p in (place / "fit").iterdir()),
                                 sorted(p.name for p in (self.root / "fit").iterdir()))  # fmt: skip
                self.assertEqual(self.started("info", "nowhere", stderr=full, prepare=prepare).returncode, 2)
                self.assertEqual(self.started("--nonsense", stderr=full, prepare=prepare).returncode, 2)
                self.assertEqual(self.started("--nonsense", program=EXPERIMENT, stderr=full, prepare=prepare).returncode, 2)
        self.assertEqual(self.reader_gone("stderr", "fit", "star", "--iterations", "1", "--replace", "-o", place / "fit").returncode, 0)

    def reader_gone(self, stream, *arguments, **others):
        reading, writing = os.pipe()
        os.close(reading)
        with open(writing, "w") as gone:
            return self.started(*arguments, **{stream: gone}, **others)

    def test_results_that_are_not_taken_are_an_error(self):
        with open("/dev/full", "w") as full:
            for command in (["info", "star"], ["info", "star", "--json"], ["judge", "fit"], ["plan", "star"], ["--help"],
                            ["--version"], ["fit", "--help"]):  # fmt: skip
                with self.subTest(command=command):
                    closed = {"prepare": lambda: os.close(1)}
                    for result in (self.started(*command, stdout=full, stderr=subprocess.PIPE),
                                   self.started(*command, stderr=subprocess.PIPE, **closed),
                                   self.reader_gone("stdout", *command, stderr=subprocess.PIPE)):  # fmt: skip
                        self.assertEqual(result.returncode, 1, result.stderr)
                        self.assertIn("standard output took only a part", result.stderr)
                        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_names_reach_the_terminal_as_text(self):
        self.refused("info", "a\x1b[2J\nb", says=[r"a\x1b[2J\nb: no such folder"])


def limit_files(bytes_):
    resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_, bytes_))
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # Python ignores it; the program must itself


class FullDisk(Writing):
    def room_for_a_part(self, *command):
        """`command`, which writes below new/, with less room than each of its files takes: status 2, one line that names
        a file there, and all that stood there before. With room for all of them: what it makes always."""
        place = self.folder("new")
        self.good(*command)
        largest = max(p.stat().st_size for p in place.rglob("*") if p.is_file())
        before = snapshot(place)
        command = (*command, "--replace")
        for room in (0, largest // 3, largest - 1):
            result = self.started(*command, prepare=lambda room=room: limit_files(room), capture_output=True)
            with self.subTest(command=command, room=room):
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(f"cannot write {place.name}/", result.stderr)
                self.assertIn("make room or choose another disk", result.stderr)
                self.assertNotIn(".radiafit-", result.stderr)
                self.assertEqual(len(complaints(result.stderr)), 1, result.stderr)
                self.assertEqual(before, snapshot(place))
        self.doCleanups()

    def test_datasets(self):
        self.room_for_a_part("generate", "star", "-o", "new/star")
        self.room_for_a_part("generate", "ornament", "-o", "new/ornament")
        self.room_for_a_part("import", "colmap", "--model", "capture/sparse", "--images", "capture/images", "--mesh",
                             "capture/mesh.ply", "-o", "new/import")  # fmt: skip

    def test_fits(self):
        for solver in (["--solver", "mean"], ["--iterations", "1"]):
            self.room_for_a_part("fit", "star", *solver, "-o", "new/fit")
        self.room_for_a_part("fit", "ornament", "--model", "lambert", "-o", "new/fit")

    def test_exports(self):
        for what in (["problems", "star"], ["problems", "ornament", "--model", "lambert"], ["parameters", "fit"]):
            self.room_for_a_part("export", *what, "-o", "new/first")

    def test_records(self):
        place = self.folder("new")
        command = ("fit", "star", "--solver", "two-step", "--iterations", "1", "-o", "new/fit")
        for where in ([], ["--records", "new/records"]):
            for room in (1000, 100_000):
                result = self.started(*command, *where, prepare=lambda room=room: limit_files(room), capture_output=True)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertRegex(result.stderr, r"cannot write .*/(radiafit-)?records/\w+\.bin: .*; make room or choose another disk\n$")
                self.assertEqual(snapshot(place), {})

    def test_pictures(self):
        for command in (["render", "fit", "-o", "new/view"], ["render", "fit", "--turntable", "3", "-o", "new/turn"],
                        ["render", "lambert", "-o", "new/view"], ["render", "lambert", "--problems", "-o", "new/map"]):  # fmt: skip
            self.room_for_a_part(*command)


class Render(Writing):
    def test_no_picture_over_what_render_did_not_make(self):
        place = self.folder("mine")
        (place / "photo.png").write_bytes(b"mine")
        (place / "sheet_sheet.png").write_bytes(b"mine")
        (place / "turn001.exr").write_bytes(b"mine")
        (place / "map.svg").write_bytes(b"mine")
        for fit, target, name in (
            ("fit", "fit/view_term0.exr", "fit/view_term0.exr"), ("fit", "mine/photo.exr", "mine/photo.png"),
            ("fit", "mine/sheet", "mine/sheet_sheet.png"), ("lambert", "lambert/albedo", None), ("lambert", "mine/photo", "mine/photo.png"),
        ):  # fmt: skip
            if name:
                self.refused("render", fit, "-o", target, says=[name, "no picture of radiafit render", "choose another name"])
        self.refused("render", "fit", "--turntable", "3", "-o", "mine", says=["mine/turn001.exr", "no picture of radiafit render"])
        self.refused("render", "lambert", "--problems", "-o", "mine/map.svg", says=["mine/map.svg", "no picture of radiafit render"])

    def test_earlier_pictures_are_replaced(self):
        place = self.folder("pictures")
        self.good("render", "fit", "--view", "0", "-o", "pictures/view")
        first = snapshot(place)
        self.good("render", "fit", "--view", "5", "--replace", "-o", "pictures/view.png")
        second = snapshot(place)
        self.assertEqual(set(first), set(second))
        self.assertFalse([name for name in first if first[name] == second[name]])
        for _ in range(2):
            self.good("render", "lambert", "--problems", "--replace", "-o", "pictures/view")
        self.assertEqual(set(snapshot(place)), {*first, "view.svg"})

    def test_problems_are_drawn_the_same_in_every_run(self):
        place = self.folder("maps")
        for name in ("a", "b"):
            self.good("render", "lambert", "--problems", "-o", f"maps/{name}")
            self.assertNotIn(b"radiafit-tmp", (place / f"{name}.svg").read_bytes())
        for ending in ("svg", "png"):
            self.assertEqual((place / f"a.{ending}").read_bytes(), (place / f"b.{ending}").read_bytes())

    def test_users_own_settings_of_gnuplot_change_nothing(self):
        place = self.folder("own")
        (place / ".gnuplot").write_text("this is no command of gnuplot\n")
        self.good("render", "lambert", "--problems", "-o", "own/plain")
        self.good("render", "lambert", "--problems", "-o", "own/set", environment={"GNUTERM": "qt", "HOME": str(place)})
        self.assertEqual((place / "plain.svg").read_bytes(), (place / "set.svg").read_bytes())

    def test_outputs_without_a_name(self):
        for more in ([], ["--turntable", "1"]):
            self.refused("render", "fit", *more, "-o", "", says=["output"])
        for folder in ("fit/", ".", ".."):
            self.refused("render", "fit", "-o", folder, says=[f"--output {folder}: names a folder; name a file"])


class Names(Writing):
    def test_behind_a_link_the_parent_is_that_of_its_target(self):
        for command in (["generate", "star"], ["fit", "star", "--iterations", "1"]):
            name = f"links-{command[0]}"
            place = self.folder(name)
            (place / "deep/inner").mkdir(parents=True)
            (place / "link").symlink_to("deep/inner")
            (place / "new").mkdir()
            (place / "new/thesis.txt").write_text("years")
            self.good(*command, "-o", f"{name}/link/../new")
            self.assertEqual((place / "new/thesis.txt").read_text(), "years")
            self.assertEqual([path.name for path in (place / "new").iterdir()], ["thesis.txt"])
            self.good("info", f"{name}/deep/new")

    def test_a_link_stays_and_what_it_leads_to_is_replaced(self):
        place = self.folder("linked")
        for name, *command in (("set", "generate", "star"), ("map", "fit", "star", "--iterations", "1")):
            self.good(*command, "-o", f"linked/{name}")
            (place / f"link-{name}").symlink_to(name)
            before = (place / name).stat().st_ino
            self.good(*command, "--replace", "-o", f"linked/link-{name}")
            self.assertEqual(os.readlink(place / f"link-{name}"), name)
            self.assertNotEqual((place / name).stat().st_ino, before)
            self.good("info", f"linked/{name}")
            (place / f"new-{name}").symlink_to(f"later-{name}")
            self.good(*command, "-o", f"linked/new-{name}")
            self.good("info", f"linked/later-{name}")
            self.assertEqual(os.readlink(place / f"new-{name}"), f"later-{name}")
            (place / f"loop-{name}").symlink_to(f"loop-{name}")
            self.refused(*command, "-o", f"linked/loop-{name}", says=[f"loop-{name}", "links"])

    def test_pictures_of_others_stay(self):
        place = self.folder("pictures")
        self.good("render", "fit", "-o", "pictures/q")
        self.good("render", "fit", "-o", "pictures/q")
        for name in ("q.png", "q.exr", "q_sheet.png"):
            mine = (place / name).read_bytes()
            (place / name).write_text("my own")
            self.refused("render", "fit", "-o", "pictures/q", says=[name, "no picture of radiafit render"])
            self.assertEqual((place / name).read_text(), "my own")
            (place / name).write_bytes(mine)
        os.mkfifo(place / "pipe.exr")
        self.refused("render", "fit", "-o", "pictures/pipe", says=["pipe.exr", "no picture"])

    def test_names_that_are_no_utf8(self):
        shutil.copytree(self.root / "star", os.path.join(os.fsencode(self.root), b"\xe9t\xe9").decode(errors="surrogateescape"))
        self.good("fit", b"\xe9t\xe9".decode(errors="surrogateescape"), "--iterations", "1", "-o", "latin")
        self.good("info", "latin")

    def test_outputs_that_cannot_be(self):
        commands = (["generate", "star"], ["fit", "star", "--iterations", "1"],
                    ["import", "colmap", "--model", "capture/sparse", "--images", "capture/images", "--mesh", "capture/mesh.ply"])  # fmt: skip
        for command in commands:
            for target in ("", "x" * 300, "star/mesh.ply/below", "/", "."):
                with self.subTest(command=command, target=target):
                    self.refused(*command, "-o", target, says=["choose " if target else "output = '': give a name"])


class Leftovers(Writing):
    def test_what_a_killed_run_left_goes_with_the_next(self):
        place = self.folder("busy")
        hidden = [place / f".radiafit-tmp-{DEAD}-0-{name}" for name in ("fit", "radiafit-records", "")]
        mine = place / ".tmp-1-0-mine"
        for command in (["fit", "star", "--iterations", "1", "-o", "busy/fit"], ["generate", "star", "-o", "busy/star"],
                        ["render", "fit", "-o", "busy/view"]):  # fmt: skip
            for path in (*hidden, mine):
                path.mkdir(exist_ok=True)
            self.good(*command)
            self.assertEqual([p.name for p in place.iterdir() if p.name.startswith(".")], [mine.name])

    def test_readers_find_what_was_being_replaced(self):
        """Killed between two renames, where a file system cannot exchange names."""
        place = self.folder("between")
        for source, command in (("star", "info"), ("fit", "info"), ("fit", "judge"), ("lambert", "judge")):
            with self.subTest(source=source, command=command):
                shutil.copytree(self.root / source, place / f".radiafit-old-{DEAD}-0-{source}")
                self.good(command, f"between/{source}", *(["--dataset", {"fit": "star", "lambert": "ornament"}[source]]
                                                         if command == "judge" else []))  # fmt: skip
                self.assertEqual([p.name for p in place.iterdir()], [source])
                shutil.rmtree(place / source)


if __name__ == "__main__":
    ProgramTest.program, EXPERIMENT = take_arguments(2)
    unittest.main()
