"""Fits that are stopped again and again, at random moments, and go on each time: they end in the bits of an undisturbed
one, and leave nothing else."""
import random
import shutil
import signal
import subprocess
import time

from kills import SIGNALS, judge_end
from scene import INPUTS, command, fit, reflectance
from tally import Tally

OFTEN = ("--resume", "--checkpoint", "0.001")

FITS = (
    fit("stream", "--terms 2", values=(150, 2, 3)),
    fit("two-step", "--solver two-step", values=(150, 2, 3)),
    fit("in parts", "--terms 2 --engine compute --memory 149M", values=(40, 2, 3)),
    fit("viewbasis", "--model viewbasis --surface-side 6", "--rank", (10, 4, 6)),
    fit("sg", "--model sg --surface-side 8", values=(40, 2, 3)),
    reflectance("lm", "", values=(200, 2, 3)),
    reflectance("with the surface's prior", "--prior surface", values=(200, 2, 3)),
    reflectance("two-step", "--solver two-step", values=(100, 2, 3)),
    command("solve by adam", f"solve {INPUTS}/decays/decays.csv --model {INPUTS}/decays/decay.glsl -o out --memory 1K --optimizer adam --start "
            "first=500,first_life=1,second=200,second_life=5,background=5", "--iterations", (60000, 2, 3)),
)  # fmt: skip


class Resumes:
    def __init__(self, scene, command, count, seed):
        self.scene, self.command, self.count = scene, command, count
        self.random = random.Random(f"{seed} resumes {command.name}")
        self.tally = Tally(f"resumes, {command.name}")

    def run(self):
        place = self.scene.place()
        place.fill(self.command, older=False)
        start = time.monotonic()
        place.run(self.command)
        duration_s = time.monotonic() - start
        self.begin_anew(place)
        while self.tally.hits < self.count and self.tally.runs < 10 * self.count:
            if self.stop_one(place, self.random.uniform(0, duration_s)):
                self.begin_anew(place)  # what was kept made it short
        status, said = place.run(self.command, more=OFTEN)
        self.tally.add(False, judge_end(place, self.command, status, said, False), "the last run")
        return self.tally

    @staticmethod
    def begin_anew(place):
        shutil.rmtree(place.folder / "out")

    def stop_one(self, place, after_s):
        """Whether the run had ended before."""
        number = self.random.choice(SIGNALS)
        process = place.start(self.command, more=OFTEN)
        try:
            process.wait(after_s)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        status, said = place.finish(process)
        killed = status == -number
        self.tally.add(killed, judge_end(place, self.command, status, said, killed),
                       f"{signal.Signals(number).name} after {after_s:.3f} s")
        return status == 0


def tasks(scene, count, seed):
    for command in FITS:
        yield Resumes(scene, command, count, seed)
