"""Rows of a run, from which the values of claims are computed anew: every topic's VALUES are {claim: what of a Run}. Nothing is
shared with the program that judges them."""
import csv
import gzip
import json
import math
from statistics import linear_regression, median

BOTH, PAPER, ALONE = ("sd", "cg"), "OpenGL (paper passes)", "OpenGL (combined passes, image by image)"
PROBLEMS = ("light field map", "Lafortune")


class Run:
    def __init__(self, folder, told):
        self.told = told  # {what was measured: its value}, by the program
        self.folder, self.config = folder, json.loads((folder / "run.json").read_text())["config"]

    def rows(self, name, **wanted):
        path = self.folder / f"{name}.csv"
        with open(path, encoding="utf-8") if path.exists() else gzip.open(f"{path}.gz", "rt", encoding="utf-8") as file:
            return [r for r in csv.DictReader(file) if all(r[k] == str(v) for k, v in wanted.items())]

    def rounds(self, name, *columns, **wanted):  # sums of columns by repetition
        return {r["repetition"]: sum(float(r[c]) for c in columns) for r in self.rows(name, **wanted)}

    def part(self, column, optimizer, method=PAPER):
        return self.rounds("iterations", column, method=method, optimizer=optimizer)


def ratio(a, b):
    return median(a[k] / b[k] for k in a if k in b)


def slope(points):  # of a straight line by least squares through logarithms
    return linear_regression(*zip(*((math.log(x), math.log(y)) for x, y in points))).slope
