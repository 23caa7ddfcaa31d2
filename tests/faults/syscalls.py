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


def tracing(log, calls, call="", inject=""):
    """What stands before a command; `inject` goes into `call`, one of `calls`. Paths of files are in the log."""
    more = ("-e", f"inject={call}:{inject}") if call else ()
    faster = () if inject.startswith("signal=") else ("--seccomp-bpf",)  # with it, no signal arrives
    return ("strace", "-f", "-qq", "-y", *faster, "-e", "signal=none", "-o", str(log), "-e", f"trace={','.join(calls)}", *more)


def calls_below(log, place):
    """Calls that name `place`, as (name, n): the n-th of this name that its thread made, which inject's `when` counts."""
    counts, found = {}, set()
    for line in log.read_text(errors="replace").splitlines():
        match = re.match(r"(\d+) +(\w+)\(", line)
        if not match:
            continue
        counts[match.groups()] = counts.get(match.groups(), 0) + 1
        if names(line, place):
            found.add((match[2], counts[match.groups()]))
    return sorted(found)


def names(line, place):
    """Whether a call is about something in `place`; relative names are, since programs run there."""
    match = re.match(r"\d+ +(\w+)\((.*)", line)
    if not match:  # the end of a call, whose beginning is another line
        return False
    call, arguments = match.groups()
    if f"<{place}" in arguments:  # an open file
        return True
    by_name = call in RENAMES or call in OTHER_CHANGES
    return by_name and (f'"{place}' in arguments or re.search(r'"(?!/)', arguments.split(" = ")[0]) is not None)


def injected(log, place):
    """Whether the fault met a call about something in `place`, and no other call: `when` counts in each thread, so that a
    pipe or a library may be met too, of which nobody expects such an error."""
    met = [names(line, place) for line in log.read_text(errors="replace").splitlines() if "(INJECTED)" in line]
    return bool(met) and all(met)
