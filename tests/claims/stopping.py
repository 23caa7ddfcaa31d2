"""Rules of experiments/claims/stopping.cpp."""
import math
from statistics import median

from claims.fixture import ClaimsTest


def stopped(residual, change, free=40, vertices=100):
    """residual and change: {levels: (share of the problems that are stopped at 3, their error over the best, spread)}."""
    rows = []
    for rule, settings in (("none", {0: (0, 1, 0)}), ("residual", residual), ("output change", change)):
        for levels, (share, error, noise) in settings.items():
            for optimizer in ("cg", "sd"):
                for v in range(vertices):
                    stops = v < share * vertices
                    rows += [{"rule": rule, "levels": levels, "optimizer": optimizer, "vertex": v, "channel": channel,
                              "stopped_at": 3 if stops else -1, "arrived_at": -1 if stops else free,
                              "error_over_best": error + noise * (v - vertices / 2) / vertices if stops else 1.001}
                             for channel in "rgb"]
    return {"problems": rows, "weights": [{"vertex": v, "weight": 0.4} for v in range(3)]}


class Stopping(ClaimsTest):
    def stopping(self, residual, change, free=40, **config):
        return self.finding("C16", "stopping", stopped(residual, change, free),
                            **{"tolerance": 1.01, "lambda": 1e-4, **config})

    def test_idle_before_arrival(self):
        early, never, late = (0.8, 2.0, 0.1), (0.0, 1.0, 0), (0.2, 1.5, 0)
        found = self.stopping({8: never, 1: early}, {8: never, 1: early})
        self.assertEqual(found["verdict"], "holds")
        self.assertIn("residual below 1/255", found["measures"][0]["of"])
        self.assertAlmostEqual(found["measures"][2]["value"], 0.2)
        alone = self.stopping({1: never}, {1: early})
        self.assertEqual(alone["verdict"], "does not hold")
        self.assertIn("the rule of the output change alone, at 1/255: holds", alone["beside"])
        self.assertIn("the rule of the residual alone, at 1/255: does not hold", alone["beside"])
        self.assertEqual(self.stopping({1: early}, {1: late})["verdict"], "does not hold", "the median problem arrives")
        self.assertEqual(self.stopping({1: early}, {1: (0.55, 1.5, 0)})["verdict"], "undecided")
        self.assertEqual(self.stopping({1: early}, {1: (0.8, 1.01, 0.01)})["verdict"], "does not hold", "good enough")
        self.assertEqual(self.stopping({1: early}, {1: early}, free=-1)["verdict"], "not comparable")
        self.assertEqual(self.stopping({1: early}, {1: early}, tolerance=1.1)["verdict"], "not comparable")
        self.assertEqual(self.stopping({8: early}, {1: early})["verdict"], "not comparable", "no such threshold")

    def test_any_threshold_was_enough_before(self):
        early, never = (0.8, 2.0, 0.1), (0.0, 1.0, 0)
        found = self.stopping({8: early, 1: never}, {8: early, 1: early})
        self.assertEqual((found["verdict"], self.other(found)), ("does not hold", "holds"))
        of = [m["of"] for m in found["former"][0]["measures"]]
        self.assertIn("residual below 8/255", of[0])
        self.assertIn("output change below 1/255", of[1])


# Values anew.


def stopping(run):  # the thresholds are in the measures' names: "residual below 0.5/255, the median problem's last error ..."
    for of in run.told:
        rule, levels = of.split("/255")[0].rsplit(" below ", 1)
        problems = [r for r in run.rows("problems", optimizer="cg", rule=rule) if float(r["levels"]) == float(levels)]
        arrived = sorted(math.inf if float(r["arrived_at"]) < 0 else float(r["arrived_at"]) for r in problems)
        last = arrived[len(arrived) // 2] - 1
        running = sum(float(r["stopped_at"]) < 0 or float(r["stopped_at"]) > last for r in problems) / len(problems)
        yield running if "still running" in of else median(float(r["error_over_best"]) for r in problems)


VALUES = {"C16": (stopping, stopping)}
