"""Inputs that change under a run: replaced by others, cut, or removed midway. It ends with one line, and all as before;
or with exit 0, and an output of the one or the other input.
"""
import json
import os
import random
import shutil
import subprocess
import time
from dataclasses import dataclass

from cli_fixture import read_png, write_png
from judge import Contents, Verdict, reference
from scene import Command, complaint
from tally import Tally


def exchange(inputs, name):
    """By rename, as a writer of ours does it."""
    os.rename(inputs / name, inputs / "aside")
    os.rename(inputs / f"other-{name}", inputs / name)


def each_image(change):
    def change_all(inputs, name):
        for path in sorted((inputs / name).rglob("*.png")):
            fresh = path.with_suffix(".fresh")
            change(inputs, path, fresh)
            if fresh.exists():
                os.replace(fresh, path)

    return change_all


def other_image(inputs, path, fresh):
    shutil.copy(str(path).replace(f"{inputs}/", f"{inputs}/other-"), fresh)


def smaller_image(_, path, fresh):
    width, height, _ = read_png(path)
    write_png(fresh, width // 2, height // 2, bytes(3 * (width // 2) * (height // 2)))


def deeper_image(_, path, fresh):
    width, height, rgb = read_png(path)
    write_png(fresh, width, height, bytes(byte for v in rgb for byte in (v, v)), depth=16)


def cut(path):
    os.truncate(path, path.stat().st_size // 2)


def cut_image(_, path, fresh):
    cut(path)


def cut_file(file):
    return lambda inputs, name: cut(inputs / name / file)


def removed_file(file):
    return lambda inputs, name: (inputs / name / file).unlink()


def removed(inputs, name):
    shutil.rmtree(inputs / name)


def scrambled(file):
    """Other bytes, as many, in a new file."""

    def scramble(inputs, name):
        path = inputs / name / file
        fresh = path.with_suffix(".fresh")
        fresh.write_bytes(bytes(255 - byte for byte in path.read_bytes()))
        os.replace(fresh, path)

    return scramble


IMAGES = {"replaced": each_image(other_image), "made smaller": each_image(smaller_image), "made deeper": each_image(deeper_image),
          "cut": each_image(cut_image), "removed": removed}
BROKEN_IMAGES = {way: IMAGES[way] for way in ("made smaller", "cut", "removed")}
DATASET = {"exchanged": exchange, "its pixels cut": cut_file("images.bin"), "its pixels removed": removed_file("images.bin"),
           "its description cut": cut_file("dataset.json"), "removed": removed}
RECORDS = {"cut": cut_file("records.bin"), "scrambled": scrambled("records.bin"), "removed": removed}
FIT = {"exchanged": exchange, "a map cut": cut_file("view_term0.exr"), "removed": removed}


@dataclass(frozen=True)
class Swap:
    name: str
    arguments: str  # IN stands for the folder of inputs
    inputs: tuple  # what of the scene's inputs is copied there, each beside an other-NAME
    changed: str
    ways: dict

    def command(self, inputs):
        return Command(self.name, (tuple(self.arguments.replace("IN", inputs).split()),))


FIT_STAR = "fit IN/star --iterations 4 -o out"
SWAPS = (
    Swap("images of import colmap", "import colmap --model IN/capture/sparse --images IN/capture/images --mesh IN/capture/mesh.ply "
         "-o out", ("capture",), "capture/images", IMAGES),
    Swap("images of import lights", "import lights --images IN/lamps/images --lights IN/lamps/lights.txt -o out",
         ("lamps",), "lamps/images", IMAGES),
    Swap("dataset of fit stream cpu", FIT_STAR, ("star",), "star", DATASET),
    Swap("dataset of fit stream fragment", f"{FIT_STAR} --engine fragment", ("star",), "star", DATASET),
    Swap("dataset of fit two-step", f"{FIT_STAR} --solver two-step", ("star",), "star", DATASET),
    Swap("dataset of fit pca", "fit IN/star --solver pca -o out", ("star",), "star", DATASET),
    Swap("records of fit two-step", f"{FIT_STAR} --solver two-step --records IN/records", ("star", "records"), "records", RECORDS),
    Swap("images of capture depths", "capture depths --model IN/capture/sparse --images IN/capture/images -o out",
         ("capture",), "capture/images", BROKEN_IMAGES),
    Swap("fit of publish", "publish IN/lfm -o out", ("star", "lfm"), "lfm", FIT),
    Swap("fit of render", "render IN/lfm --turntable 4 -o out", ("star", "lfm"), "lfm", FIT),
)


class Swapping:
    def __init__(self, scene, swap, count, seed):
        self.scene, self.swap, self.count = scene, swap, count
        self.random = random.Random(f"{seed} swaps {swap.name}")
        self.tally = Tally(f"swaps, {swap.name}")
        self.place = scene.place()
        self.inputs = scene.root / "swapped" / self.place.folder.name
        self.command = swap.command(f"../../swapped/{self.place.folder.name}")

    def run(self):
        self.references, self.duration_s = [], 0
        for exchanged in (True, False):
            self.references.append(self.undisturbed(exchanged))
        for way in self.swap.ways:
            for _ in range(self.count):
                self.change_midway(way)
        return self.tally

    def fill(self, exchanged=False):
        shutil.rmtree(self.inputs, ignore_errors=True)
        self.inputs.mkdir(parents=True)
        for name in self.swap.inputs:
            for prefix in ("", "other-"):
                self.scene.make(f"{prefix}{name}")
                shutil.copytree(self.scene.root / "inputs" / f"{prefix}{name}", self.inputs / f"{prefix}{name}")
        if exchanged and "replaced" in self.swap.ways:
            self.swap.ways["replaced"](self.inputs, self.swap.changed)
        elif exchanged:
            exchange(self.inputs, self.swap.inputs[-1])
        self.place.fill(self.command, older=False)

    def undisturbed(self, exchanged):
        self.fill(exchanged)
        start = time.monotonic()
        status, said = self.place.run(self.command)
        if status != 0:
            raise RuntimeError(f"{self.swap.name}: status {status}: {said}")
        self.duration_s = time.monotonic() - start
        return reference(self.place.folder, self.place.before), self.pixels()

    def pixels(self):
        """Of each view of an import; elsewhere nothing."""
        folder = self.place.folder / "out"
        if not (folder / "images.bin").exists():
            return None
        data, views = (folder / "images.bin").read_bytes(), json.loads((folder / "dataset.json").read_text())["views"]
        ends = [view["pixel_offset"] for view in views[1:]] + [len(data)]
        return [data[view["pixel_offset"] : end] for view, end in zip(views, ends)]

    def change_midway(self, way):
        self.fill()
        share = self.random.uniform(0, 1)
        process = self.place.start(self.command)
        try:
            process.wait(share * self.duration_s)
        except subprocess.TimeoutExpired:
            pass
        hit = process.poll() is None
        self.swap.ways[way](self.inputs, self.swap.changed)
        self.tally.add(hit, self.judge(*self.place.finish(process)), f"{way} after {share * self.duration_s:.3f} of {self.duration_s:.2f} s")

    def judge(self, status, said):
        verdict = Verdict(self.place.folder, self.place.before, [contents for contents, _ in self.references])
        if status == 0:
            return [] if self.is_a_mixture_by_view() else verdict.after_success()
        wrong = complaint(status, said)
        return verdict.after_failure(steps=False) + ([wrong] if wrong else [])

    def is_a_mixture_by_view(self):
        """Whether every view of an import holds the one or the other image, and `info` finds nothing wrong."""
        mine = self.pixels()
        if mine is None or subprocess.run([str(self.scene.programs["radiafit"]), "info", "out"], cwd=self.place.folder,
                                          capture_output=True, check=False).returncode != 0:
            return False
        first, second = (pixels for _, pixels in self.references)
        return len(mine) == len(first) and all(pixels in pair for pixels, pair in zip(mine, zip(first, second)))


def tasks(scene, count, seed):
    for swap in SWAPS:
        yield Swapping(scene, swap, count, seed)
