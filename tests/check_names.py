#!/usr/bin/env python3
"""No text of the program compares with the name of a family, a model, an engine, a solver or an optimizer: each stands in
one table, and what depends on it is a member there. Usage: check_names.py [ROOT]"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)


def text(path):
    return (root / path).read_text(encoding="utf-8")


def names():
    """Of all tables."""
    found = re.findall(r'\.name = "([^"]+)"', text("src/fits/fitting/solvers/solvers.cpp"))
    found += re.findall(r'\{\.name = "([^"]+)"', text("src/core/optim/methods.h"))
    found += re.findall(r'\{\{"([^"]+)", "', text("src/fits/reference/ceres_solver.cpp"))
    found += re.findall(r'lfm_name = "([^"]+)"', text("src/core/model/lfm.h"))
    found += re.findall(r'\{"([^"]+)", EngineKind::', text("src/fits/fitting/fit_options.cpp"))
    found += re.search(r"set\(texel_models([^)]*)\)", text("src/core/model/CMakeLists.txt"))[1].split()
    return found


def comparisons(line, known):
    for literal in re.findall(r'[=!]=\s*"([^"]*)"', line) + re.findall(r'"([^"]*)"\s*[=!]=', line):
        if literal in known:
            yield literal


def main():
    known = set(names())
    for needed in ("lfm", "lafortune", "fragment", "cpu", "two-step", "tinysolver", "lbfgs", "sd", "dense-schur"):
        if needed not in known:
            sys.exit(f"check_names.py no longer finds '{needed}' in its table; correct names()")
    bad = []
    for folder in ("src", "experiments"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                for literal in comparisons(line, known):
                    bad.append(f'{path.relative_to(root)}:{number}: compares with "{literal}"; give its table a member')
    if bad:
        sys.exit("\n".join(bad))
    print(f"no text compares with one of {len(known)} names")


if __name__ == "__main__":
    main()
