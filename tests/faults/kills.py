"""Runs that are killed: at random moments, and at every rename. Afterwards every output is whole: old or new.

Several runs are killed in one place, one after another; what they left there, one undisturbed run must clean.
"""
import random
import signal
import subprocess
import time

from scene import COMMANDS, complaint
from syscalls import OTHER_CHANGES, RENAMES, calls_below, tracing
from tally import Tally

SIGNALS = (signal.SIGKILL,) * 4 + (signal.SIGINT, signal.SIGTERM)
ATTEMPTS = 3  # for each kill that is wanted: a run may have ended before


def described(older):
    return "over an older output" if older else "onto an empty place"


def judge_end(place, command, status, said, killed):
    verdict = place.verdict(command)
    if status == 0:
        return verdict.after_success()
    if killed:
        return verdict.after_kill()
    wrong = complaint(status, said)
    return verdict.after_failure(command.steps) + ([wrong] if wrong else [])


class RandomKills:
    """Every third is aimed at the last moments, where outputs take their names."""

    def __init__(self, scene, command, older, count, seed):
        self.scene, self.command, self.older, self.count = scene, command, older, count
        self.random = random.Random(f"{seed} kills {command.name} {older}")
        self.tally = Tally(f"kills, {command.name}, {described(older)}")
        self.duration_s = None

    def run(self):
        place = self.scene.place()
        place.fill(self.command, self.older)
        self.measure(place)
        while self.tally.hits < self.count and self.tally.runs < ATTEMPTS * self.count:
            place.restore(self.command, self.older)
            self.kill_one(place)
        place.restore(self.command, self.older)
        self.tally.violations += place.run_clean(self.command)
        return self.tally

    def measure(self, place):
        start = time.monotonic()
        place.run(self.command)
        self.duration_s = time.monotonic() - start

    def kill_one(self, place):
        last = self.tally.runs % 3 == 2
        share = self.random.uniform(0.9, 1) if last else self.random.uniform(0, 1)
        number = self.random.choice(SIGNALS)
        start = time.monotonic()
        process = place.start(self.command)
        try:
            process.wait(share * self.duration_s)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        status, said = place.finish(process)
        if status == 0:  # the machine has become faster
            self.duration_s = min(self.duration_s, time.monotonic() - start)
        killed = status == -number
        how = f"{signal.Signals(number).name} after {share:.3f} of {self.duration_s:.2f} s"
        self.tally.add(killed, judge_end(place, self.command, status, said, killed), how)


class KillsAtChanges:
    """At the first, second, … rename, and at some other changes of folders and files."""

    def __init__(self, scene, command, older, others, seed):
        self.scene, self.command, self.older, self.others = scene, command, older, others
        self.random = random.Random(f"{seed} renames {command.name} {older}")
        self.tally = Tally(f"kills at renames, {command.name}, {described(older)}")

    def run(self):
        place = self.scene.place()
        log = place.temporary.parent / f"{place.folder.name}.log"
        for calls, limit in ((RENAMES, None), (OTHER_CHANGES, self.others)):
            place.fill(self.command, self.older)
            place.run(self.command, wrapper=tracing(log, calls))
            moments = calls_below(log, place.folder)
            if limit is not None:
                moments = sorted(self.random.sample(moments, min(limit, len(moments))))
            for call, n in moments:
                place.restore(self.command, self.older)
                self.kill_at(place, log, call, n)
        place.restore(self.command, self.older)
        self.tally.violations += place.run_clean(self.command)
        return self.tally

    def kill_at(self, place, log, call, n):
        status, said = place.run(self.command, wrapper=tracing(log, (call,), call, f"signal=SIGKILL:when={n}"))
        killed = status == -signal.SIGKILL
        self.tally.add(killed, judge_end(place, self.command, status, said, killed), f"killed at {call}, the {n}th")


def tasks(scene, count, seed, traced):
    for command in COMMANDS:
        for older in command.states():
            yield RandomKills(scene, command, older, count, seed)
            if traced:
                yield KillsAtChanges(scene, command, older, 2 * count, seed)
