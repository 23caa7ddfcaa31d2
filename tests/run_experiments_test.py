#!/usr/bin/env python3
"""scripts/run-experiments.sh and scripts/install-packages.sh, over a made-up tree and made-up programs."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent / "scripts"

# Stands for an experiment: leaves one result folder and one figure, and fails if its name says so.
EXPERIMENT = """#!/bin/sh
name=$(basename "$0")
echo "$name $*" >> log
[ -t 0 ] && exit 9
case $name in *broken*) exit 3 ;; *stopped*) kill -INT $$ ;; esac
for time in 20240101T000000Z 20240102T000000Z; do
    mkdir -p "results/$name/cpu-$time/$time-abc"
    touch "results/$name/cpu-$time/$time-abc/run.json"
done
figures=paper_figs
[ "$4" = standard ] || figures=paper_figs/$4
mkdir -p "$figures"
touch "$figures/$name.svg" "paper_figs/$name.gp"
"""


class Tree(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-scripts-"))
        self.addCleanup(shutil.rmtree, self.root)

    def program(self, path, text):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)


class RunExperiments(Tree):
    def run_script(self, *arguments):
        return subprocess.run([str(self.root / "scripts/run-experiments.sh"), *arguments], capture_output=True, text=True,
                              stdin=subprocess.DEVNULL)

    def make(self, *names):
        for script in ("run-experiments.sh", "profile-needs.py"):
            self.program(f"scripts/{script}", (SCRIPTS / script).read_text(encoding="utf-8"))
        for name in names:
            self.program(f"experiments/{name}.toml", "")
            self.program(f"build/experiments/{name}", EXPERIMENT)

    def log(self):
        log = self.root / "log"
        return log.read_text(encoding="utf-8").splitlines() if log.exists() else []

    def test_order_arguments_and_where_to_look(self):
        self.make("claims", "report", "streaming", "fig7_convergence", "fig8_time", "table1_datasets")
        result = self.run_script("build", "smoke")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.log(), [f"{name} --config experiments/{name}.toml --profile smoke" for name in
                                      ("table1_datasets", "fig7_convergence", "fig8_time", "streaming", "claims", "report")])
        self.assertIn("  results/report/smoke/index.html  (", result.stdout)
        self.assertIn("  paper_figs/smoke/fig7_convergence.svg\n", result.stdout)
        self.assertNotIn(".gp", result.stdout)
        self.assertIn("  results/streaming/cpu-20240102T000000Z/20240102T000000Z-abc/", result.stdout)
        self.assertNotIn("20240101", result.stdout)

    def test_only(self):
        self.make("fig7_convergence", "fig8_time")
        self.assertEqual(self.run_script("--list").stdout, "fig7_convergence\nfig8_time\n")
        self.assertEqual(self.run_script("--list", "fig8").stdout, "fig8_time\n")
        self.assertEqual(self.run_script("build", "smoke", "fig8").returncode, 0)
        self.assertEqual(len(self.log()), 1)
        for arguments in (("build", "smoke", "fig99"), ("--list", "fig99")):
            result = self.run_script(*arguments)
            self.assertEqual(result.returncode, 2)
            self.assertEqual(result.stderr, "no experiment's name contains 'fig99'; there are: fig7_convergence fig8_time\n")

    def test_a_failure_is_told_and_the_rest_still_runs(self):
        self.make("fig1_broken", "fig2_good")
        result = self.run_script("build", "smoke")
        self.assertEqual(result.returncode, 3)
        self.assertIn("fig1_broken: failed", result.stdout)
        self.assertIn("paper_figs/smoke/fig2_good.svg", result.stdout)

    def test_a_signal_ends_it_and_what_is_done_stays(self):
        self.make("fig1_good", "fig2_stopped", "fig3_later")
        result = self.run_script("build", "smoke")
        self.assertEqual(result.returncode, 130)
        self.assertEqual(len(self.log()), 2)
        self.assertIn("paper_figs/smoke/fig1_good.svg", result.stdout)
        self.assertIn("fig2_stopped: failed", result.stdout)
        self.assertIn("fig3_later: not run", result.stdout)

    def test_the_paper_profile_tells_its_needs_and_goes_on_where_it_was_broken_off(self):
        self.make("fig7_convergence", "fig8_time", "streaming", "claims", "report")
        for name, minutes, bytes in (("fig7_convergence", 60, 3e9), ("fig8_time", 90, 2e9)):
            folder = self.root / "results/reference" / name / "cpu/20240101T000000Z-abc"
            folder.mkdir(parents=True)
            (folder / "run.json").write_text(json.dumps({
                "profile": "paper", "wall_s": 60 * minutes, "peak_memory_bytes": bytes, "cpu": "C", "cores": 2,
                "datasets": [{"checksum": "star", "bytes": 4e8}, {"checksum": name, "bytes": 1e8}]}))
        (folder / "times.csv").write_text("method,bytes_written\nfirst,1500000000\nsecond,\n")
        result = self.run_script("build", "paper")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("took 2.5 h on C, 2 cores, at most 3.0 GB of memory, and 2.1 GB of disk\n", result.stderr)
        self.assertIn("no paper run to tell the needs of: streaming\n", result.stderr)
        self.assertEqual({line.split(" ", 1)[1].split(" ", 2)[2] for line in self.log()}, {"--profile paper --resume"})
        self.assertEqual(self.run_script("build", "standard").returncode, 0)
        self.assertNotIn("--resume", self.log()[-1])


class InstallPackages(Tree):
    """With programs of our own on PATH in place of dpkg-query, apt-get, id and sudo."""

    def run_script(self, installed, *arguments, **programs):
        shutil.rmtree(self.root / "bin", ignore_errors=True)
        (self.root / "log").unlink(missing_ok=True)
        self.program("bin/dpkg-query", "#!/bin/sh\nfor last; do :; done\n"
                     f"case ' {installed} ' in *' all '* | *\" $last \"*) echo 'install ok installed' ;; *) exit 1 ;; esac\n")
        self.program("bin/apt-get", f'#!/bin/sh\necho "apt-get $*" >> "{self.root}/log"\n')
        self.program("bin/id", "#!/bin/sh\necho 0\n")
        for name in ("awk", "cat", "env", "mktemp", "rm", "sh", "sleep", "touch", "true"):
            os.symlink(shutil.which(name), self.root / "bin" / name)
        for name, text in programs.items():
            path = "bin/" + name.replace("_", "-")
            if text is None:
                (self.root / path).unlink()
            else:
                self.program(path, text)
        result = subprocess.run(["/bin/sh", str(SCRIPTS / "install-packages.sh"), *arguments], capture_output=True, text=True,
                                stdin=subprocess.DEVNULL, env={"PATH": str(self.root / "bin")})
        log = self.root / "log"
        return result, log.read_text(encoding="utf-8") if log.exists() else ""

    def test_nothing_missing_nothing_said(self):
        result, log = self.run_script("all")
        self.assertEqual((result.returncode, result.stdout, result.stderr, log), (0, "", "", ""))

    def test_only_what_is_missing_is_installed(self):
        result, log = self.run_script("g++ cmake git make")
        self.assertEqual(result.returncode, 0, result.stderr)
        install = log.splitlines()[-1].split()
        self.assertIn("install", install)
        self.assertIn("gnuplot-nox", install)
        self.assertNotIn("cmake", install)

    def test_without_apt_one_line(self):
        result, log = self.run_script("", apt_get=None)
        self.assertEqual((result.returncode, log), (1, ""))
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertIn("no apt-get here", result.stderr)

    def test_sudo_where_not_root(self):
        sudo = '#!/bin/sh\necho "sudo $1" >> "' + str(self.root) + '/log"\nshift\nexec "$@"\n'
        result, log = self.run_script("g++", id="#!/bin/sh\necho 1000\n", sudo=sudo)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("sudo -n\n", log)
        self.assertIn("apt-get install", log)

    def test_neither_root_nor_sudo(self):
        result, log = self.run_script("g++", id="#!/bin/sh\necho 1000\n")
        self.assertEqual((result.returncode, log), (1, ""))
        self.assertIn("cannot install without sudo", result.stderr)

    def test_a_failed_installation_is_told(self):
        for command in (), ("--", "true"):
            with self.subTest(command):
                result, _ = self.run_script("g++", "test", *command, apt_get="#!/bin/sh\necho no disk >&2\nexit 100\n")
                self.assertEqual(result.returncode, 1)
                self.assertIn("no disk\n", result.stderr)
                self.assertTrue(result.stderr.splitlines()[-1].startswith("could not install: "), result.stderr)

    def test_what_is_to_be_downloaded_is_told(self):
        apt_get = "#!/bin/sh\ncase $* in *--print-uris*) for n in 1 2 3; do echo \"'http://a/b$n.deb' b$n.deb 1300000 X\"; done ;; esac\n"
        result, _ = self.run_script("g++", "experiments", apt_get=apt_get)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"^installing, 4 MB to download: cmake ")

    def test_each_part_has_its_own(self):
        asked = {}
        for part in ("experiments", "build", "test-programs", "test"):
            result, log = self.run_script("", part)
            self.assertEqual(result.returncode, 0, result.stderr)
            asked[part] = {word for word in log.splitlines()[-1].split() if not word.startswith("-")}
        self.assertLess(asked["experiments"], asked["build"])
        self.assertLess(asked["build"], asked["test-programs"])
        self.assertLess(asked["test-programs"], asked["test"])
        for package in asked["experiments"]:  # no photographs' formats, page, browser, tests, ranks, checks
            self.assertNotRegex(package, "openimageio|node|npm|chromium|gtest|mpi|clang|glsl|spirv|benchmark|numpy|matplotlib|pybind")
        result, log = self.run_script("", "everything")
        self.assertEqual((result.returncode, log, result.stderr.count("\n")), (2, "", 1))

    def test_a_command_runs_meanwhile(self):
        """The command and apt-get each wait for the other to begin."""
        meet = "touch {0}; n=0; until [ -e {1} ]; do n=$((n + 1)); [ $n -lt 200 ] || exit 9; sleep 0.05; done; "
        command, apt_get = (meet.format(f"'{self.root}/{mine}'", f"'{self.root}/{other}'")
                            for mine, other in (("command", "apt-get"), ("apt-get", "command")))  # fmt: skip
        apt_get = f"#!/bin/sh\ncase $* in *--print-uris*) ;; *' install '*) {apt_get} sleep 0.2; echo \"$*\" >>'{self.root}/log' ;; esac\n"
        for status in 0, 3:
            result, log = self.run_script("g++", "test", "--", "sh", "-c", f"{command} echo built; exit {status}", apt_get=apt_get)
            self.assertEqual((result.returncode, result.stdout), (status, "built\n"), result.stderr)
            self.assertIn("chromium", log)  # it was waited for
            for name in "command", "apt-get":
                (self.root / name).unlink()
        result, log = self.run_script("all", "test", "--", "sh", "-c", "exit 3")
        self.assertEqual((result.returncode, result.stderr, log), (3, "", ""))


if __name__ == "__main__":
    unittest.main()
