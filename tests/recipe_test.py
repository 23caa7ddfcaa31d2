#!/usr/bin/env python3
"""What others make the environment, the archive and the captures again with: scripts/make-archive.sh, debian-sources.sh and
bare-root.sh, Containerfile, CITATION.cff, datasets/checksums."""
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import tarfile
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
IDENTITY = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@b", "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@b",
            "GIT_AUTHOR_DATE": "2003-07-27T23:00:00 -0700", "GIT_COMMITTER_DATE": "2003-07-27T23:00:00 -0700",
            "GIT_CONFIG_GLOBAL": "/dev/null", "GIT_CONFIG_SYSTEM": "/dev/null"}  # fmt: skip


def text(path):
    return (ROOT / path).read_text(encoding="utf-8")


class Folder(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-recipe-"))
        self.addCleanup(shutil.rmtree, self.root)

    def run_in(self, folder, *command, status=0, umask=0o022, **environment):
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False,
                              env={"PATH": os.environ["PATH"], **IDENTITY, **environment}, umask=umask)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done


@unittest.skipUnless(shutil.which("git"), "no git")
class Archive(Folder):
    def setUp(self):
        super().setUp()
        self.made = self.root / "made"
        for path in ("scripts/make-archive.sh", "cmake/revision.txt", ".gitattributes", "CMakeLists.txt"):
            (self.made / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, self.made / path)
        # In an archive the revision is there already.
        (self.made / "cmake/revision.txt").write_text("$Format:%H$\n", encoding="utf-8")
        (self.made / "results/reference").mkdir(parents=True)
        (self.made / "results/reference/rows b.csv").write_text("a,b\n1,2\n", encoding="utf-8")
        self.run_in(self.made, "git", "init", "-q")
        self.run_in(self.made, "git", "add", "-A")
        self.run_in(self.made, "git", "commit", "-qm", "all")
        self.commit = self.run_in(self.made, "git", "rev-parse", "HEAD").stdout.strip()

    def archive(self, checkout, **environment):
        said = self.run_in(checkout, "scripts/make-archive.sh", "out", **environment).stdout
        (file,) = (checkout / "out").glob("*.tar.gz")
        digest = hashlib.sha256(file.read_bytes()).hexdigest()
        self.assertEqual(said, f"{digest}  {file.stat().st_size} bytes  out/{file.name}\n")
        self.assertEqual((checkout / "out" / (file.name + ".sha256")).read_text(), f"{digest}  {file.name}\n")
        return file

    def test_two_checkouts_give_the_same_bytes(self):
        self.run_in(self.root, "git", "clone", "-q", "made", "cloned", umask=0o077)
        a = self.archive(self.made, TZ="Asia/Tokyo")
        b = self.archive(self.root / "cloned", umask=0o077, LC_ALL="C.UTF-8")
        self.assertEqual(a.name, b.name)
        self.assertRegex(a.name, rf"^radiafit-[0-9.]+-20030728-{self.commit[:12]}\.tar\.gz$")
        self.assertEqual(a.read_bytes(), b.read_bytes())

    def test_it_holds_the_reference_checksums_and_its_revision(self):
        with tarfile.open(self.archive(self.made)) as tar:
            tar.extractall(self.root / "there")
            self.assertEqual({member.mtime for member in tar}, {1059372000})
        (top,) = (self.root / "there").iterdir()
        self.run_in(top, "sha256sum", "--check", "--quiet", "SHA256SUMS")
        listed = {line[66:] for line in (top / "SHA256SUMS").read_text().splitlines()}
        there = {"./" + p.relative_to(top).as_posix() for p in top.rglob("*") if p.is_file()} - {"./SHA256SUMS"}
        self.assertEqual(listed, there)
        self.assertIn("./results/reference/rows b.csv", listed)
        self.assertEqual((top / "cmake/revision.txt").read_text(), self.commit + "\n")

    def test_what_is_not_committed_is_refused(self):
        with open(self.made / "CMakeLists.txt", "a", encoding="utf-8") as file:
            file.write("# more\n")
        said = self.run_in(self.made, "scripts/make-archive.sh", "out", status=2)
        self.assertIn("commit or stash", said.stderr)
        self.assertFalse((self.made / "out").exists())


class Environment(Folder):
    def sources(self, *arguments, **more):
        return self.run_in(self.root, "sh", str(ROOT / "scripts/debian-sources.sh"), *arguments, **more)

    def test_one_day_or_today(self):
        pinned, today = self.sources().stdout, self.sources("").stdout
        day = re.search(r"^ARG SNAPSHOT=(\S+)$", text("Containerfile"), re.M)[1]
        self.assertEqual(pinned, self.sources(day).stdout)
        self.assertEqual(pinned.count(f"/{day} bookworm"), 3)
        self.assertIn(f"debian:bookworm-{day[:8]}-slim", text("Containerfile"))
        self.assertEqual(today.count("http://deb.debian.org/"), 3)
        self.assertIn("deb http://mirror/debian bookworm main\n", self.sources("", MIRROR="http://mirror").stdout)
        self.assertIn("no date", self.sources("yesterday", status=2).stderr)

    def test_bare_root_refuses_what_it_does_not_know(self):
        for variables, word in (({"PROFILE": "large"}, "choose smoke, standard or paper"),
                                ({"RUN": "test; rm"}, "no target"), ({"SNAPSHOT": "now"}, "no date")):  # fmt: skip
            said = self.run_in(self.root, "sh", str(ROOT / "scripts/bare-root.sh"), status=2, **variables)
            self.assertIn(word, said.stderr)
            self.assertEqual(said.stderr.count("\n"), 1)

    def test_scripts_are_programs(self):
        for script in (ROOT / "scripts").glob("*.sh"):
            self.assertTrue(os.access(script, os.X_OK), script.name)

    def test_the_citation_names_this_version(self):
        version = re.search(r"^project\(radiafit VERSION ([0-9.]+)", text("CMakeLists.txt"), re.M)[1]
        self.assertIn(f"\nversion: {version}\n", text("CITATION.cff"))


if __name__ == "__main__":
    unittest.main()
