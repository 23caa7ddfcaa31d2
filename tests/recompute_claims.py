#!/usr/bin/env python3
"""Every value of the claims, computed anew from the rows alone (tests/claims/anew.py).

    recompute_claims.py CLAIMS.json FOLDER...     the folders below which the runs lie that it names
"""
import json
import math
import pathlib
import sys

from claims import convergence, images, samples, scale, stopping, time
from claims.anew import Run

VALUES = {claim: values for topic in (convergence, images, samples, scale, stopping, time) for claim, values in topic.VALUES.items()}


def same(a, b):
    return a == b if a is None or b is None else math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12)


def main(claims, *folders):
    compared, wrong = set(), 0
    document = json.loads(pathlib.Path(claims).read_text())
    for c in [c for c in document["claims"] + document["varied"] if c["run"]]:
        (folder,) = [pathlib.Path(f, c["run"]) for f in folders if pathlib.Path(f, c["run"]).exists()]
        rules = [c["measures"], *(r["measures"] for r in c["readings"] + c.get("former", []))]
        for i, (measures, values) in enumerate(zip(rules, VALUES[c["id"]], strict="former" in c)):
            told = {m["of"]: m["value"] for m in measures}
            for (of, value), mine in zip(told.items(), values(Run(folder, told)) if told else (), strict=True):
                compared.add((c["id"], c.get("profile", c.get("settings")), i, of))
                if not same(value, mine):
                    wrong += 1
                    print(f"{c['id']}, {c.get('settings') or c['profile'] + ' profile'}, rule {i}, {of}: {value} there, {mine} by the rows")
    print(f"{len(compared)} values of {len({c[0] for c in compared})} claims, by {len({c[:3] for c in compared})} rules, {wrong} differ")
    return bool(wrong or not compared)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
