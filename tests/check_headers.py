#!/usr/bin/env python3
"""Every header of src/ compiles alone, and all of them together, each ring with those within it: none leans on what another
file happens to include before it, and no two define one name. Precompiled headers would hide the former.
Usage: check_headers.py BUILD_FOLDER, of a configured build, for the headers that it generates."""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Texts that are included after definitions of their own.
PARTS = {"model/define_texel_text.h"}


def flags_of(build):
    """The compiler, its flags and include folders, of all sources of src/ together."""
    compiler, folders, flags = None, [], ["-std=c++20"]
    for entry in json.loads((build / "compile_commands.json").read_text()):
        words = shlex.split(entry["command"])
        if not words[words.index("-o") + 1].startswith("src/"):
            continue
        compiler = next(word for word in words if re.search(r"(\+\+|clang)[-\d.]*$", word))
        for i, word in enumerate(words):
            found = [word] if word.startswith(("-I", "-D", "-march=")) else words[i : i + 2] if word == "-isystem" else []
            folders += [" ".join(found)] if found and " ".join(found) not in folders else []
    return [compiler, *flags, *(word for folder in folders for word in folder.split(" "))]


def compile_text(command, text, label, folder):
    source = pathlib.Path(folder) / (re.sub(r"\W", "_", label) + ".cpp")
    source.write_text(text)
    done = subprocess.run([*command, "-fsyntax-only", "-Wno-psabi", source], capture_output=True, text=True, check=False)
    return [] if done.returncode == 0 else [f"{label}:\n{done.stderr[:1500]}"]


def main():
    command = flags_of(pathlib.Path(sys.argv[1]))
    headers = {}  # of each ring, as they are included
    for path in sorted((ROOT / "src").rglob("*.h")):
        ring, name = path.relative_to(ROOT / "src").as_posix().split("/", 1)
        if name not in PARTS:
            headers.setdefault(ring, []).append(name)
    texts = [(f"{ring}/{name}", f'#include "{name}"\n') for ring, names in headers.items() for name in names]
    texts.append(("all together", "".join(f'#include "{name}"\n' for names in headers.values() for name in names)))
    with tempfile.TemporaryDirectory(prefix="radiafit-headers-") as folder:
        with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads:
            errors = sum(threads.map(lambda text: compile_text(command, text[1], text[0], folder), texts), [])
    print("\n".join(errors) if errors else f"{len(texts) - 1} headers compile alone, and all together")
    return 1 if errors or len(texts) == 1 else 0


if __name__ == "__main__":
    sys.exit(main())
