"""Rules of experiments/claims/samples.cpp."""
from claims.fixture import ClaimsTest


class Samples(ClaimsTest):
    def found(self, median=26, facing=1500, shared=0, names=("star", "bust"), kept=970, without=10, fixed=30):
        """median, facing, shared: of sides by projected size; kept (of 1000 pixels), without (a sample), fixed (the median texel's
        samples): of one side for all, on the bust."""
        tables = {"datasets": [{"dataset": name, "sides": sides,
                                "shared_texels": shared if (name, sides) == ("bust", "own") else 1 - (sides == "own")}
                               for name in names for sides in ("one", "own")]}  # fmt: skip
        for name in names:
            one = (kept, without, fixed) if name == "bust" else (970, 10, 30)
            for files, texels, pixels, none, middle in ((name, 500, *one),
                                                        (name + "_own_sides", facing, 700, 10, median if name == "bust" else 30)):
                tables[files + "_images"] = [{"image": i, "covered_pixels": 1000, "kept_pixels": pixels,
                                              "facing_texels": texels + i - 2} for i in range(5)]  # fmt: skip
                tables[files + "_samples_per_texel"] = [{"samples": n, "texels": count} for n, count in
                                                        ((0, none), (9, 20), (middle, 300), (90, 50))]  # fmt: skip
        return self.finding("C17", "table1_datasets", tables)

    def test_pixels_and_texels(self):
        row = self.found()
        self.assertEqual(row["verdict"], "holds")
        self.assertIn("of the bust's pixels, for each of which 0.5 texels face the camera in the median image, 97 % reach a texel, "
                      "2.63 % of its texels have no sample, and the median texel has 30", row["sentence"])  # fmt: skip
        self.assertIn("70 % of the bust's pixels (1.5 texels for each) reach one", row["sentence"])
        self.assertIn("star, sides by projected size: 1.5 texels per covered pixel in the median image, 30 samples in the "
                      "median texel; 30.0 % of the pixels are dropped, because no texel takes them; 2.6 % of the texels have "
                      "no sample, 7.9 % fewer than 10; 0 times a texel took two pixels of one image", row["beside"])  # fmt: skip
        self.assertIn("star, one side for all: 0.5 texels", " ".join(row["beside"]))
        for changed in ({"kept": 940}, {"without": 30}, {"fixed": 8}):
            self.assertEqual(self.found(**changed)["verdict"], "does not hold", changed)
        self.assertEqual(self.found(names=("bust",))["verdict"], "not comparable")

    def test_own_sides_decided_before(self):
        def former(**changed):
            return self.other(self.found(**changed))

        self.assertEqual(former(), "holds")
        self.assertEqual(former(kept=100), "holds")
        self.assertEqual(former(median=8), "does not hold")
        self.assertEqual(former(shared=1), "does not hold")
        row = self.found(facing=900)
        self.assertEqual((row["verdict"], self.other(row)), ("holds", "not comparable"))
        self.assertIn("bust has 0.9", row["former"][0]["reason"])
        self.assertEqual(former(names=("bust",)), "not comparable")


# Values anew.


def middle(texels):
    return next(i for i in range(len(texels)) if sum(texels[: i + 1]) >= sum(texels) / 2)


def own_sides(run):
    rows = run.rows("datasets", sides="own")
    texels = [[int(r["texels"]) for r in run.rows(row["dataset"] + "_own_sides_samples_per_texel")] for row in rows]
    return [*map(middle, texels), *(float(row["shared_texels"]) for row in rows)]


def one_side(run):
    names = [r["dataset"] for r in run.rows("datasets", sides="one") if r["dataset"] in ("star", "bust")]
    texels = [[int(r["texels"]) for r in run.rows(name + "_samples_per_texel")] for name in names]
    for name in names:
        images = run.rows(name + "_images")
        yield sum(float(r["kept_pixels"]) for r in images) / sum(float(r["covered_pixels"]) for r in images)
    yield from (t[0] / sum(t) for t in texels)
    yield from map(middle, texels)


VALUES = {"C17": (one_side, own_sides)}
