"""Disks that are full: file systems of every size up to that of the whole output, errors from single writes, and
standard output and error that take nothing. Afterwards an output is whole and new with exit 0, or all is as before.
"""
import contextlib
import os
import random
import resource
import signal
import subprocess

from kills import described
from scene import COMMANDS, complaint
from syscalls import RENAMES, WRITES, calls_below, injected, tracing
from tally import Tally

PAGE = 4096
CURE = "make room"


def can_mount(folder):
    """Whether this process may mount a file system: root may, mostly."""
    folder.mkdir(parents=True, exist_ok=True)
    return mount(folder, PAGE) and unmount(folder)


def mount(folder, size):
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "radiafit-faults", str(folder)]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def unmount(folder):
    return subprocess.run(["umount", str(folder)], capture_output=True, check=False).returncode == 0


def size_of(folder):
    """Bytes that a file system needs for what is in a folder."""
    sizes = [PAGE]
    for at, folders, files in os.walk(folder):
        sizes += [PAGE] * len(folders)
        sizes += [-(-os.lstat(os.path.join(at, name)).st_size // PAGE) * PAGE for name in files]
    return sum(sizes)


def judge_end(place, command, status, said, late=False):
    """`late`: an error may come after the last rename, when all is new already, but perhaps not on the disk."""
    verdict = place.verdict(command)
    if status == 0:
        return verdict.after_success()
    wrong = [text for text in [complaint(status, said)] if text]
    return verdict.after_failure(command.steps or (late and verdict.all_new())) + wrong


class SmallDisks:
    """By turns onto an empty place and over an older output; runs that would look at the room first are forced to begin,
    but for one. Where mounting is not permitted, no file may grow beyond the size instead.
    """

    def __init__(self, scene, command, steps, mounting):
        self.scene, self.command, self.steps, self.mounting = scene, command, steps, mounting
        self.tally = Tally(f"{'full disk' if mounting else 'files that may not grow'}, {command.name}")

    def run(self):
        whole = size_of(self.scene.undisturbed(self.command, 0)[1])
        sizes = [(PAGE + step * (whole - PAGE) // (self.steps - 1)) // PAGE * PAGE for step in range(self.steps)]
        for step, size in enumerate(sizes):
            self.run_with(size, self.command.states()[step % len(self.command.states())], self.command.forced())
        if self.command.forced() and self.mounting:
            self.run_with(sizes[0], True, ())
        return self.tally

    def run_with(self, size, older, more):
        with self.place_of(size) as (place, options):
            place.fill(self.command, older)
            if self.mounting:
                self.leave_room(place, size)
            status, said = place.run(self.command, more=more, **options)
            violations = judge_end(place, self.command, status, said)
            if status != 0 and CURE not in said:
                violations.append(f"doesn't say '{CURE}': {said.strip()[-200:]}")
            self.tally.add(status != 0, violations, f"{size} bytes of room, {described(older)}{'' if more else ', not forced'}")

    @contextlib.contextmanager
    def place_of(self, size):
        place = self.scene.place()
        if not self.mounting:
            yield place, {"preexec_fn": lambda: limit_files(size)}
            return
        place.folder.mkdir(parents=True)
        if not mount(place.folder, "1G"):
            raise RuntimeError(f"cannot mount a file system at {place.folder}")
        try:
            yield place, {}
        finally:
            unmount(place.folder)

    def leave_room(self, place, size):
        used = os.statvfs(place.folder)
        taken = (used.f_blocks - used.f_bfree) * used.f_frsize
        command = ["mount", "-o", f"remount,size={taken + size}", str(place.folder)]
        subprocess.run(command, capture_output=True, check=True)


def limit_files(size):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


class FailingCalls:
    """One call fails, the next ones succeed: a disk that was full for a moment, or that lost a block."""

    def __init__(self, scene, command, older, count, seed):
        self.scene, self.command, self.older, self.count = scene, command, older, count
        self.random = random.Random(f"{seed} calls {command.name} {older}")
        self.tally = Tally(f"failing calls, {command.name}, {described(older)}")

    def run(self):
        place = self.scene.place()
        log = place.temporary.parent / f"{place.folder.name}.log"
        for calls, error in ((WRITES, "ENOSPC"), (RENAMES, "EIO"), (("fsync", "fdatasync", "close"), "EIO")):
            place.fill(self.command, self.older)
            place.run(self.command, wrapper=tracing(log, calls))
            moments = calls_below(log, place.folder)
            for call, n in sorted(self.random.sample(moments, min(self.count, len(moments)))):
                place.fill(self.command, self.older)
                status, said = place.run(self.command, wrapper=tracing(log, (call,), call, f"error={error}:when={n}"))
                hit = injected(log, place.folder)
                violations = judge_end(place, self.command, status, said, late=True) if hit else []
                self.tally.add(hit, violations, f"{error} from {call}, the {n}th")
        return self.tally


class FullStreams:
    """Standard error that takes nothing is no reason to stop; standard output is, of commands that print there."""

    def __init__(self, scene, command):
        self.scene, self.command = scene, command
        self.tally = Tally(f"full standard error and output, {command.name}")

    def run(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            place = self.scene.place()
            place.fill(self.command, older=True)
            status, _ = place.run(self.command, stderr=full)
            violations = judge_end(place, self.command, status, "") if status == 0 else [f"exit status {status}"]
            self.tally.add(True, violations, "standard error")
            place.fill(self.command, older=True)
            status, said = place.run(self.command, stdout=full)
            violations = place.verdict(self.command).problems
            if status != 0 and (complaint(status, said) or "standard output" not in said):
                violations.append(f"exit status {status}: {said.strip()}")
            self.tally.add(status != 0, violations, "standard output")
        return self.tally


def tasks(scene, count, seed, traced, mounting):
    for command in COMMANDS:
        yield SmallDisks(scene, command, 20, mounting)
        if traced:
            for older in command.states():
                yield FailingCalls(scene, command, older, count, seed)
        yield FullStreams(scene, command)
