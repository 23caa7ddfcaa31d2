#!/usr/bin/env python3
"""Every source that takes precompiled headers is optimized and contracts as they were compiled. GCC takes both from the
headers, and says nothing where the source's own flags differ: kernels would lose what they gain by fused additions.
Usage: check_precompiled.py BUILD_FOLDER"""
import json
import pathlib
import shlex
import sys


def options_of(words):
    """The optimization and the contraction, of each the last that is given."""
    return {kind: ([word for word in words if word.startswith(kind)] or [""])[-1] for kind in ("-O", "-ffp-contract")}


def main():
    commands = json.loads((pathlib.Path(sys.argv[1]) / "compile_commands.json").read_text())
    headers, sources = {}, []
    for command in commands:
        words = shlex.split(command["command"])
        included = [words[i + 1] for i, word in enumerate(words) if word == "-include" and "cmake_pch" in words[i + 1]]
        if "cmake_pch" in pathlib.Path(command["file"]).name:
            headers[command["file"].removesuffix(".cxx")] = options_of(words)
        elif included:
            sources.append((command["file"], included[-1], options_of(words)))
    errors = [f"{file} is compiled by {found}, its precompiled headers by {headers[header]}: choose others, or none"
              for file, header, found in sources if found != headers[header]]
    print("\n".join(errors) if errors else f"{len(sources)} sources are compiled as their {len(headers)} precompiled headers")
    return 1 if errors or not headers or not sources else 0


if __name__ == "__main__":
    sys.exit(main())
