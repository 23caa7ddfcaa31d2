"""Faults at chosen system calls, by strace: a kill at the n-th rename, an error from the n-th write."""
import re
import shutil
import subprocess

RENAMES = ("rename", "renameat", "renameat2")
OTHER_CHANGES = ("mkdir", "mkdirat", "unlink", "unlinkat", "rmdir", "fsync", "fdatasync", "ftruncate", "fallocate")
WRITES = ("write", "writev", "pwrite64", "pwritev", "ftruncate", "fallocate")


def can_trace():
    """Whether there is an strace, and this machine lets it work."""
    if not shutil.which("strace"):
        return False
    return subprocess.run(["strace", "-o", "/dev/null", "true"], capture_output=True, check=False).returncode == 0


def tracing(log, calls, inject=""):
    """What stands before a command. Paths of files are in the log."""
    names = ",".join(calls)
    more = ("-e", f"inject={names}:{inject}") if inject else ()
    faster = () if inject.startswith("signal=") else ("--seccomp-bpf",)  # with it, no signal arrives
    return ("strace", "-f", "-qq", "-y", *faster, "-e", "signal=none", "-o", str(log), "-e", f"trace={names}", *more)


def calls_below(log, place):
    """Which of its thread's traced calls each call was that names `place`: what inject's `when` counts. Sorted."""
    counts, found = {}, set()
    for line in log.read_text(errors="replace").splitlines():
        match = re.match(r"(\d+) +(\w+)\(", line)
        if not match:
            continue
        counts[match[1]] = counts.get(match[1], 0) + 1
        if names(line, place):
            found.add(counts[match[1]])
    return sorted(found)


def names(line, place):
    """Whether a call is about something in `place`; relative names are, since programs run there."""
    arguments = line.split("(", 1)[1]
    return str(place) in arguments or re.search(r'"(?!/)', arguments.split(" = ")[0]) is not None


def injected(log, place):
    """Whether the fault met a call about something in `place`."""
    lines = log.read_text(errors="replace").splitlines()
    return any("(INJECTED)" in line and names(line, place) for line in lines)
