"""Three writers into one folder at once: those that come second are refused, what stands there at the end is one of theirs,
whole, and it never goes away while there is one."""
import os
import threading

from kills import described
from scene import COMMANDS, complaint
from tally import Tally

SECOND = ("another run is writing it",  # what a writer says who comes second
          "appeared meanwhile", "exists already")  # or late, to a place that was empty


class Watcher(threading.Thread):
    """Looks, as often as it can, whether the outputs that stood there still do."""

    def __init__(self, place):
        super().__init__()
        self.paths = [os.path.join(place.folder, name) for name in place.before.exact]
        self.gone, self.done = set(), threading.Event()

    def run(self):
        while not self.done.wait(0.0002):
            self.gone.update(path for path in self.paths if not os.path.lexists(path))

    def finish(self):
        self.done.set()
        self.join()
        return [f"{path} was not there for a moment" for path in sorted(self.gone)]


class Writers:
    def __init__(self, scene, command, older, count):
        self.scene, self.command, self.older, self.count = scene, command, older, count
        self.tally = Tally(f"three writers, {command.name}, {described(older)}")

    def run(self):
        place = self.scene.place()
        for _ in range(self.count):
            place.fill(self.command, self.older)
            self.tally.add(True, self.write_at_once(place), "three at once")
        return self.tally

    def write_at_once(self, place):
        watcher = Watcher(place)
        watcher.start()
        processes = [place.start(self.command, variant) for variant in (0, 1, 2)]
        ends = [place.finish(process) for process in processes]
        violations = watcher.finish()
        for status, said in ends:
            if status != 0 and (complaint(status, said) or not any(text in said for text in SECOND)):
                violations.append(f"a writer failed: exit status {status}: {said.strip()[-200:]}")
        if all(status != 0 for status, _ in ends):
            violations.append("no writer succeeded")
        verdict = place.verdict(self.command, (0, 1, 2))
        return violations + verdict.problems + [f"leftover {name}" for name in verdict.leftovers]


def tasks(scene, count):
    for command in COMMANDS:
        for older in command.states():
            yield Writers(scene, command, older, count)
