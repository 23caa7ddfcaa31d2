#!/usr/bin/env python3
"""What others make the environment, the archive and the captures again with: scripts/make-archive.sh, debian-sources.sh and
bare-root.sh, Containerfile, CITATION.cff, datasets/checksums."""
import hashlib
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import unittest
import zlib

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


class Captures(Folder):
    def find(self, name, **variables):
        for file in ("datasets/scripts/find_capture.sh", *(f"datasets/checksums/{n}" for n in ("a.sha256", "a-again.sha256"))):
            (self.root / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "datasets/scripts/find_capture.sh", self.root / "datasets/scripts")
        for list_name, content in (("a", b"first"), ("a-again", b"second")):
            line = f"{hashlib.sha256(content).hexdigest()}  images/1.png\n"
            (self.root / f"datasets/checksums/{list_name}.sha256").write_text(line, encoding="ascii")
        (self.root / "captures/a/images").mkdir(parents=True, exist_ok=True)
        status = variables.pop("status", 0)
        return self.run_in(self.root, "datasets/scripts/find_capture.sh", name, status=status,
                           RADIAFIT_CAPTURES=str(self.root / "captures"), **variables)

    def test_the_files_are_compared(self):
        self.assertIn("1 of 1 files are missing", self.find("a", status=2).stderr)
        image = self.root / "captures/a/images/1.png"
        for content in (b"first", b"second"):
            image.write_bytes(content)
            done = self.find("a")
            self.assertEqual((done.stdout, done.stderr), (str(self.root / "captures/a") + "\n", ""))
        image.write_bytes(b"third")
        said = self.find("a", status=2)
        self.assertEqual(said.stdout, "")
        self.assertIn("1 of 1 files", said.stderr)
        self.assertIn("RADIAFIT_OTHER_CAPTURE=1", said.stderr)
        done = self.find("a", RADIAFIT_OTHER_CAPTURE="1")
        self.assertEqual(done.stdout, str(self.root / "captures/a") + "\n")
        self.assertIn("1 of 1 files", done.stderr)

    def test_what_is_not_there_is_told(self):
        self.assertIn("no capture", self.find("b", status=2).stderr)
        self.find("a", status=2)
        shutil.rmtree(self.root / "captures/a")
        done = self.run_in(self.root, "datasets/scripts/find_capture.sh", "a", status=2, RADIAFIT_CAPTURES="captures")
        self.assertIn("captures.md", done.stderr)

    def test_lists_name_files_within_the_capture(self):
        for path in (ROOT / "datasets/checksums").glob("*.sha256"):
            for line in path.read_text(encoding="ascii").splitlines():
                self.assertRegex(line, r"^[0-9a-f]{64}  [\w][\w./-]*$")
                self.assertNotIn("..", line)

    def test_every_script_and_the_page_name_the_source(self):
        page = text("datasets/captures.md")
        for script, capture in (("cards_blue", "cards_blue"), ("diligent_reading", "diligent_reading"),
                                ("gold_cape", "mold_gold_cape")):  # fmt: skip
            script = text(f"datasets/scripts/{script}.sh")
            (commit,) = re.findall(r"\b[0-9a-f]{40}\b", script)
            row = next(line for line in page.splitlines() if line.startswith(f"| `{capture}`"))
            self.assertIn(commit, row)
            self.assertIn(re.search(r"github\.com/[\w/-]+", row)[0], script)
            self.assertIn(f'find_capture.sh" {capture})', script)

    def test_diligent_is_cropped_without_a_change(self):
        """A made-up original: pictures whose rows have every filter, normals in a MATLAB file."""
        width, height, place = 612, 512, (196, 127, 219, 232)
        source, target = self.root / "source", self.root / "target"
        source.mkdir()
        gold = [bytes((x * 7 + y * 13 + x * y) % 251 for x in range(width * 6)) for y in range(height)]
        (source / "a.png").write_bytes(png(width, 16, 2, gold))
        (source / "mask.png").write_bytes(png(width, 8, 0, [row[:width] for row in gold]))
        normals = [float(i % 1013) / 1013 for i in range(height * width * 3)]
        (source / "Normal_gt.mat").write_bytes(matlab("Normal_gt", (height, width, 3), normals))
        for name, content in (("filenames.txt", "a.png\n"), ("light_directions.txt", "0 0 1\n"), ("light_intensities.txt", "1 1 1\n")):
            (source / name).write_text(content, encoding="ascii")
        self.run_in(self.root, sys.executable, "-B", str(ROOT / "datasets/scripts/prepare_diligent_reading.py"), "source", "target")
        x, y, w, h = place
        self.assertEqual(stored_rows(target / "images/a.png"), [row[6 * x : 6 * (x + w)] for row in gold[y : y + h]])
        self.assertEqual(stored_rows(target / "mask.png"), [row[x : x + w] for row in gold[y : y + h]])
        pfm = (target / "normal_gt.pfm").read_bytes()
        self.assertTrue(pfm.startswith(b"PF\n219 232\n-1.0\n"))
        values = struct.unpack(f"<{3 * w * h}f", pfm[-12 * w * h :])
        for row, column, channel in ((0, 0, 0), (5, 7, 1), (h - 1, w - 1, 2)):
            expected = normals[(channel * width + x + column) * height + y + row]
            self.assertAlmostEqual(values[((h - 1 - row) * w + column) * 3 + channel], expected, places=6)


def png(width, depth, colour, rows):
    """A PNG whose rows take the five filters in turn."""
    pixel, raw, before = (3 if colour == 2 else 1) * depth // 8, b"", bytes(len(rows[0]))
    for y, row in enumerate(rows):
        left, corner = bytes(pixel) + row[:-pixel], bytes(pixel) + before[:-pixel]
        guess = [bytes(len(row)), left, before, bytes((a + b) // 2 for a, b in zip(left, before)),
                 bytes(min((a, b, c), key=lambda v: (abs(a + b - c - v), (a, b, c).index(v)))
                       for a, b, c in zip(left, before, corner))][y % 5]  # fmt: skip
        raw += bytes([y % 5]) + bytes((v - g) & 255 for v, g in zip(row, guess))
        before = row
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", width, len(rows), depth, colour, 0, 0, 0)), (b"IDAT", zlib.compress(raw, 1)),
              (b"IEND", b""))  # fmt: skip
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
                                           for kind, body in chunks)  # fmt: skip


def stored_rows(path):
    """Rows of a PNG all of whose rows are unfiltered."""
    data = path.read_bytes()
    width, height, depth, colour = struct.unpack_from(">IIBB", data, 16)
    length = struct.unpack_from(">I", data, 33)[0]
    raw, line = zlib.decompress(data[41 : 41 + length]), width * (3 if colour == 2 else 1) * depth // 8 + 1
    return [raw[y * line + 1 : (y + 1) * line] for y in range(height)]


def matlab(name, sizes, values):
    """A MATLAB file, version 5, of one compressed matrix of doubles."""
    def element(kind, body):
        return struct.pack("<II", kind, len(body)) + body + bytes(-len(body) % 8)

    matrix = (element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack(f"<{len(sizes)}i", *sizes))
              + element(1, name.encode()) + element(9, struct.pack(f"<{len(values)}d", *values)))  # fmt: skip
    packed = zlib.compress(element(14, matrix), 1)
    return bytes(128) + struct.pack("<II", 15, len(packed)) + packed


if __name__ == "__main__":
    unittest.main()
