"""Rules of experiments/claims/convergence.cpp."""
from collections import defaultdict
from statistics import median, quantiles

from claims.fixture import ClaimsTest

CONFIG = {"lambda": 1e-4, "tolerance": 1.01, "cap": 3000, "ends_cap": 30000}


def spread(low, high, count):
    """From low to high, evenly on a logarithmic axis."""
    return [low * (high / low) ** (i / (count - 1)) for i in range(count)]


def problems(star=(10, 12), bust=None, cg=20, newton=15, names=("star", "bust"), missing=0, penalty=0.0, vertices=100):
    """Three problems per vertex, with such ratios of iterations; SD never arrives in a share `missing` of them."""
    rows = []
    for name, (low, high) in zip(names, (star, bust or star)):
        for v, ratio in enumerate(spread(low, high, vertices)):
            for channel in "rgb":
                sd = -1 if v < missing * vertices else round(cg * ratio)
                rows.append({"dataset": name, "lambda": 0.0001, "vertex": v, "channel": channel, "best_error": 1,
                             "best_solver": "varpro", "varpro_penalty": penalty, "cg_paper": cg, "cg_modern": cg / 2, "sd": sd,
                             "sd_growing": round(cg * ratio / 2), "varpro": newton})
    rows.append({**rows[0], "lambda": 0.001, "sd": -1})
    return rows


SUMMARY = [{"dataset": "star", "lambda": lam, "cap": 3000, "ratio_quartile1": 4, "ratio_median": 10, "ratio_quartile3": 20,
            "cg_censored_share": 0.01, "sd_censored_share": 0.1} for lam in (0.0001, 0.001)]


def ends(apart=0.2, lower=0.9, moving=0.0, vertices=120, minima=(0.2, 0.9)):
    """Of each vertex's three problems: a share `apart` of the vertices has ends 2 % apart, CG below in a share `lower`; minima: the
    same of the minima."""
    def error(v, apart, lower):
        return (1.02 if v < lower * apart * vertices else 0.98) if v < apart * vertices else 1.001

    rows = []
    for v in range(vertices):
        end, sd = error(v, apart, lower), error(v, *minima)
        for channel in "rgb":
            rows.append({"dataset": "star", "vertex": v, "channel": channel, "cg_error": 1, "sd_error": end, "cg_at_rest": 1,
                         "sd_at_rest": int(v % 2), "cg_minimum": 1, "sd_minimum": sd, "cg_minimum_at_rest": 1,
                         "sd_minimum_at_rest": int(v < (1 - moving) * vertices)})
    return rows


class Convergence(ClaimsTest):
    def fig7(self, claim, rows=None, end_rows=None, **config):
        tables = {"problems": rows or problems(), "summary": SUMMARY, "ends": end_rows or ends()}
        return self.finding(claim, "fig7_convergence", tables, **{**CONFIG, **config})

    def test_iteration_ratio(self):
        found = self.fig7("C1")
        self.assertEqual(found["verdict"], "holds")
        self.assertAlmostEqual(found["measures"][0]["value"], 11, delta=0.1)
        low, high = found["measures"][0]["interval"]
        self.assertTrue(10.5 < low < 11 < high < 11.5)
        self.assertRegex(found["sentence"], r"10\.9 \(10\.8 to 11\.2\) times on the star, 10\.9 times in the 100 % of its problems")
        self.assertTrue(any("lambda = 0.001" in text for text in found["beside"]))
        self.assertTrue(any("sweeps" in text and " 5.4" in text for text in found["beside"]))
        self.assertEqual(self.fig7("C1", problems((2, 4)))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C1", problems(bust=(2, 4)))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C1", problems((4, 6)))["verdict"], "undecided")
        self.assertEqual(self.fig7("C1", problems(cg=3))["verdict"], "holds")

    def test_who_does_not_arrive_bounds_the_ratio(self):
        half = self.fig7("C1", problems((2, 2), missing=0.6))
        self.assertEqual(half["measures"][0]["value"], 3000 / 20, "at least")
        self.assertIn("2 times in the 40 % of its problems where both arrive", half["sentence"])
        self.assertIsNone(half["measures"][0]["interval"][1], "and anything above")
        self.assertTrue(any("60 % of SD's problems" in text for text in half["beside"]))
        few = self.fig7("C1", problems((2, 2), missing=0.45))
        self.assertEqual((few["measures"][0]["value"], few["verdict"]), (2, "undecided"), "the median may be one of those that did not")
        both = self.fig7("C1", problems((2, 2), cg=-1, missing=1))
        self.assertEqual((both["measures"][0]["value"], both["verdict"]), (None, "undecided"), "nothing is known of any")
        self.assertEqual((both["former"][0]["measures"][0]["value"], self.other(both)), (1, "does not hold"))
        self.assertEqual((half["former"][0]["measures"][0]["value"], self.other(half)), (150, "undecided"))

    def test_premises(self):
        for other in ({"cap": 300}, {"tolerance": 1.1}, {"lambda": 0.001}):
            for claim in ("C1", "C19", "C22"):
                self.assertEqual(self.fig7(claim, **other)["verdict"], "not comparable", other)
        star = self.fig7("C1", problems(names=("star",)))
        self.assertEqual(star["verdict"], "not comparable")
        self.assertIn("the bust", star["reason"])

    def test_newton_rate(self):
        self.assertEqual(self.fig7("C19")["verdict"], "holds")
        self.assertIn("take 0.667 (bust), 0.667 (star) times as many", self.fig7("C19")["sentence"], "modern CG: 10 against 15")
        self.assertEqual(self.fig7("C19", problems(newton=5))["verdict"], "does not hold")
        rows = problems()
        for row in rows:  # half of the vertices at a ratio of 1.9, half at 2.2
            row["varpro"] = 10.5 if int(row["vertex"]) % 2 else 9
        self.assertEqual(self.fig7("C19", rows)["verdict"], "undecided")
        rows = problems()
        for row in rows:  # where bounds are at work, nothing is compared
            if int(row["vertex"]) < 20:
                row.update(varpro=1, varpro_penalty=0.1)
        found = self.fig7("C19", rows)
        self.assertEqual(found["verdict"], "holds")
        self.assertTrue(any("20 % of the problems are left out" in text for text in found["beside"]))
        self.assertEqual(self.fig7("C19", problems(penalty=0.1))["verdict"], "not comparable")

    def test_consistent_ratio(self):
        self.assertEqual(self.fig7("C22")["verdict"], "holds")
        self.assertEqual(self.fig7("C22", problems((1, 1000)))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C22", problems((10, 12), (20, 22)))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C22", problems((20, 22), (10, 12)))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C22", problems((1, 8)))["verdict"], "undecided")

    def test_better_minimum(self):
        found = self.fig7("C2")
        self.assertEqual(found["verdict"], "holds")
        self.assertAlmostEqual(found["measures"][0]["value"], 0.2)
        self.assertAlmostEqual(found["measures"][1]["value"], 0.9, places=1)
        self.assertEqual(self.fig7("C2", end_rows=ends(lower=0.1))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C2", end_rows=ends(lower=0.6))["verdict"], "undecided")
        self.assertEqual(self.fig7("C2", end_rows=ends(apart=0))["verdict"], "does not hold")
        self.assertEqual(self.fig7("C2", end_rows=ends(apart=0.05))["verdict"], "undecided")
        self.assertEqual(self.fig7("C2", end_rows=ends(vertices=90))["verdict"], "not comparable")
        self.assertIn("where both methods came to rest by themselves: of 180 problems 36 are more than 1 % apart, "
                      "CG the lower in 33 of them", found["beside"])

    def test_minima_are_another_reading(self):
        found = self.fig7("C2")
        self.assertEqual(found["readings"][0]["name"], "as mathematics")
        for kind in ("readings", "former"):
            self.assertEqual(self.other(found, kind), "holds")
            apart = self.fig7("C2", end_rows=ends(minima=(0.2, 0.1)))
            self.assertEqual((apart["verdict"], self.other(apart, kind)), ("holds", "does not hold"))
            self.assertEqual(self.other(self.fig7("C2", end_rows=ends(minima=(0.05, 0.9))), kind), "undecided")
            moving = self.fig7("C2", end_rows=ends(moving=0.5))
            self.assertEqual((moving["verdict"], self.other(moving, kind)), ("holds", "not comparable"))
            self.assertIn("did not come to rest", moving[kind][0]["reason"])


# Values anew.


def arrivals(run, above, below, comparable=False):  # ratios of iterations, dataset by dataset, the bust first
    out, cap = defaultdict(list), run.config["cap"]
    for r in run.rows("problems"):
        if float(r["lambda"]) == run.config["lambda"] and not (comparable and abs(float(r["varpro_penalty"])) > 1e-3):
            a, b = (cap if float(r[s]) < 0 else max(1, float(r[s])) for s in (above, below))
            out[r["dataset"]].append(a / b)
    return [out[name] for name in sorted(out)]


def bounded(run):  # the least that each ratio may be, of the problems of which either arrives
    out, cap = defaultdict(list), run.config["cap"]
    for r in run.rows("problems"):
        sd, cg = float(r["sd"]), float(r["cg_paper"])
        if float(r["lambda"]) == run.config["lambda"] and max(sd, cg) >= 0:
            out[r["dataset"]].append((cap if sd < 0 else max(1, sd)) / max(1, cg) if cg >= 0 else 0)
    return [median(out[name]) for name in sorted(out)]


def pairs_apart(pairs):
    apart = [(cg, sd) for cg, sd in pairs if max(cg, sd) > 1.01 * min(cg, sd)]
    return len(apart) / max(1, len(pairs)), sum(cg < sd for cg, sd in apart) / len(apart) if apart else None


def ends_of(run):
    return pairs_apart([[float(r[f"{o}_error"]) for o in ("cg", "sd")] for r in run.rows("ends")])


def minima(run):
    return pairs_apart([[float(r[f"{o}_minimum"]) for o in ("cg", "sd")] for r in run.rows("ends")
                        if float(r["cg_minimum_at_rest"]) and float(r["sd_minimum_at_rest"])])


# Of each claim, by its rule, then by its other readings and by its former rules.
VALUES = {
    "C1": (bounded, lambda run: map(median, arrivals(run, "sd", "cg_paper"))),
    "C2": (ends_of, minima, minima),
    "C19": (lambda run: map(median, arrivals(run, "cg_paper", "varpro", comparable=True)),),
    "C22": (lambda run: (lambda qs: [q[2] / q[0] for q in qs] + [max(q[1] for q in qs) / min(q[1] for q in qs)])(
        [quantiles(r, n=4, method="inclusive") for r in arrivals(run, "sd", "cg_paper")]),),
}
