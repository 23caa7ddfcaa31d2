"""Commands over a finished output of another: they are refused, and it is as it was; the same command again says that it is done."""
import time

from scene import COMMANDS, complaint
from tally import Tally

DONE_WITHIN_S = 1


class Unasked:
    def __init__(self, scene, command):
        self.scene, self.command = scene, command
        self.tally = Tally(f"unasked, {command.name}")

    def run(self):
        place = self.scene.place()
        place.fill(self.command, older=True)
        status, said = place.run(self.command, 0, asked=False)
        wrong = [] if status == 2 else [f"exit status {status}, not 2"]
        if complaint(status, said) or "--replace" not in said:
            wrong.append(f"not a line with the cure: {said.strip()[-200:]}")
        self.tally.add(True, wrong + place.verdict(self.command).after_failure(steps=False), "another command")

        start = time.monotonic()
        status, said = place.run(self.command, 1, asked=False)
        took_s = time.monotonic() - start
        wrong = [] if status == 0 and "done already" in said else [f"exit status {status}: {said.strip()[-200:]}"]
        if took_s > DONE_WITHIN_S:
            wrong.append(f"took {took_s:.1f} s")
        self.tally.add(True, wrong + place.verdict(self.command).after_failure(steps=False), "the same command")
        return self.tally


def tasks(scene):
    for command in COMMANDS:
        if command.program == "radiafit":  # results of experiments have names of their own
            yield Unasked(scene, command)
