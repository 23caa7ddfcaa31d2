#!/usr/bin/env python3
"""Every value of the claims, computed anew from the rows alone (tests/claims/anew.py).

    recompute_claims.py CLAIMS.json FOLDER...     the folders below which the runs lie that it names
"""
import json
import math
import pathlib
import sys

from claims import convergence, images, scale, time
from claims.anew import Run

VALUES = convergence.VALUES | images.VALUES | scale.VALUES | time.VALUES


def main(claims, *folders):
    compared, wrong = set(), 0
    for c in [c for c in json.loads(pathlib.Path(claims).read_text())["claims"] if c["run"] and c["measures"]]:
        (folder,) = [pathlib.Path(f, c["run"]) for f in folders if pathlib.Path(f, c["run"]).exists()]
        told = {m["of"]: m["value"] for m in c["measures"]}
        for (of, value), mine in zip(told.items(), VALUES[c["id"]](Run(folder, told)), strict=True):
            compared.add((c["id"], c["profile"], of))
            if value != mine if value is None or mine is None else not math.isclose(value, mine, rel_tol=1e-9, abs_tol=1e-12):
                wrong += 1
                print(f"{c['id']}, {c['profile']} profile, {of}: {value} there, {mine} by the rows")
    print(f"{len(compared)} values of {len({c for c, _, _ in compared})} claims, {wrong} differ")
    return bool(wrong or not compared)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
