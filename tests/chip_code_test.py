#!/usr/bin/env python3
"""What scripts/r300 counted by Mesa's compiler, and docs/paper.md prints of it, is of the passes that there are now. Without Mesa."""
import csv
import json
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts/r300"))
import chip_code
import interpret
import spirv_to_floats

# A row of the page's table: its groups of passes. A group: "each" of its parts has a number of its own, or "from to" is told of them
# all; FITTING where only the programs that fit are meant. A part: shader and words of the variant, absent ones behind "!"; of several
# rows the most.
FITTING = True
ROWS = {
    "`distribute/item.frag`": [("each", ["distribute/item.frag"])],
    "`gather/residual.frag`": [("each", ["gather/residual.frag PROJECTED VALUES=0"])],
    "`gather/footprint.frag`, either result": [
        ("each", ["gather/footprint.frag NEAREST ONLY=1", "gather/footprint.frag NEAREST ONLY=0"])],
    "`gather/look_up.frag`": [("each", ["gather/look_up.frag"])],
    "`gather/line_term.frag`": [("from to", ["gather/line_term.frag"])],
    "`gather/surface_gradient.frag`": [("each", ["gather/surface_gradient.frag !DIAGONAL"])],
    "`gather/scatter.frag`": [("each", ["gather/scatter.frag !DIAGONAL"])],
    "`gather/tile_texels.frag`: 15 entries, their squares, 7 products": [
        ("each", ["gather/tile_texels.frag TURNS=15 !SQUARE !MAXIMUM", "gather/tile_texels.frag SQUARE",
                  "gather/tile_texels.frag PRODUCT !DIAGONAL"])],
    "`gather/band_sum.frag`, 3 and 6 bands": [("each", ["gather/band_sum.frag TURNS=3 !MAXIMUM", "gather/band_sum.frag TURNS=6"])],
    "`gather/ring_sum.frag`": [("each", ["gather/ring_sum.frag !MAXIMUM"])],
    "`gather/view_sum.frag`": [("each", ["gather/view_sum.frag !MAXIMUM"])],
    "`optimize/gradient.frag`, `optimize/laplacian.frag`": [("each", ["optimize/gradient.frag", "optimize/laplacian.frag"])],
    "penalties and `optimize/dot.frag` of light field maps": [
        ("from to", ["optimize/penalty_curvature.frag", "optimize/penalty_error.frag", "optimize/dot.frag TERMS=1"])],
    "`optimize/step.frag`: a trial judged, each result": [("from to", ["optimize/step.frag PROBLEMS=vertices STEP=judge_trial"])],
    "`optimize/step.frag`: a step's length, Eq. 7; with the exact line search": [
        ("each", ["optimize/step.frag PROBLEMS=vertices STEP=step_length"], FITTING),
        ("each", ["optimize/step.frag PROBLEMS=vertices STEP=step_length"])],
    "`optimize/update.frag`, each vector": [("from to", ["optimize/update.frag ELEMENTS=map_elements"])],
    "`optimize/summary.frag`, of problems and of blocks": [("each", ["optimize/summary.frag !FURTHER", "optimize/summary.frag FURTHER"])],
    "Lafortune: `reflect/residual.frag`": [("each", ["reflect/residual.frag MODEL=lafortune !TARGET_ONLY"])],
    "Lafortune: `reflect/direction.frag`, three results; `reflect/line.frag`": [
        ("each", [f"reflect/direction.frag MODEL=lafortune !DIAGONAL ONLY={i}" for i in range(3)]),
        ("each", ["reflect/line.frag MODEL=lafortune"])],
    "Lafortune: gradients, penalties, dot products, steps (Eq. 7), updates": [
        ("from to", ["reflect/gradient.frag MODEL=lafortune", "reflect/penalty.frag MODEL=lafortune", "optimize/dot.frag TERMS=3",
                     "optimize/step.frag PROBLEMS=texels", "optimize/update.frag MODEL=lafortune"], FITTING)],
}


def of_part(rows, part):
    shader, *words = part.split()
    found = [row for row in rows if row["shader"] == shader
             and all((word.lstrip("!") in row["variant"].split()) != word.startswith("!") for word in words)]
    assert found, part
    return found


def told(rows, how, parts, column):
    """A cell's text of one group."""
    found = [[int(row[column]) for row in of_part(rows, part)] for part in parts]
    if how == "each":
        numbers = [max(some) for some in found]
        return str(numbers[0]) if len(set(numbers)) == 1 else ", ".join(map(str, numbers))
    every = sum(found, [])
    return f"{min(every)} to {max(every)}" if min(every) < max(every) else str(every[0])


def line_of(rows, name, groups):
    cells = [name]
    for column in ("slots", "look_ups", "levels"):
        each = [told(rows, how, parts, "longest_fitting" if fitting and column == "slots" else column) for how, parts, *fitting in groups]
        cells.append("; ".join(dict.fromkeys(each)))
    fits = [bool(fitting) or all(row["fitting"] == row["programs"] for part in parts for row in of_part(rows, part))
            for _, parts, *fitting in groups]
    cells.append("; ".join(dict.fromkeys("yes" if one else "no" for one in fits)))
    return f"| {' | '.join(cells)} |"


class Counted(unittest.TestCase):
    def setUp(self):
        with chip_code.MEASURED.open(encoding="utf-8", newline="") as file:
            self.rows = list(csv.DictReader(file))
        page = (ROOT / "docs/paper.md").read_text(encoding="utf-8")
        self.section = re.search(r"^##### In the chip's own code\n.*?(?=^#)", page, re.M | re.S)[0]
        self.above = page[: page.index(self.section)]
        self.words = " ".join(self.section.split())

    def cells(self, text, first, columns):
        """The next cells of the last row in text whose first cell is that."""
        return re.findall(rf"^\| {re.escape(first)} \| (.*) \|$", text, re.M)[-1].split(" | ")[:columns]

    def test_every_pass_is_counted_as_it_is_declared(self):
        wanted = [(shader, variant, str(operations), str(reads)) for shader, variant, (operations, reads, _) in chip_code.passes()]
        found = [(row["shader"], row["variant"], row["operations"], row["reads"]) for row in self.rows]
        self.assertGreater(len(wanted), 100)
        again = f"count anew: python3 -B scripts/r300/chip_code.py FOLDER --csv {chip_code.MEASURED.relative_to(ROOT)}"
        self.assertEqual(sorted(set(wanted) - set(found)), [], f"passes that the csv doesn't have; {again}")
        self.assertEqual(sorted(set(found) - set(wanted)), [], f"rows of no pass; {again}")
        self.assertEqual(found, wanted, again)

    def test_the_page_has_the_rows_numbers(self):
        table = re.search(r"^\| pass \| slots \|.*?\n\|[-|]+\n((?:\|.*\n)+)", self.section, re.M)[1].splitlines()
        self.assertEqual(table, [line_of(self.rows, name, groups) for name, groups in ROWS.items()])
        most = {column: max(int(row[column]) for row in self.rows) for column in ("levels", "look_ups", "temporaries")}
        fitting = sum(row["fitting"] == row["programs"] for row in self.rows)
        self.assertIn(f"{fitting} of {len(self.rows)} passes fit", self.words)
        self.assertEqual(most["levels"], 4)
        self.assertIn(f"Four levels, {most['look_ups']} look-ups and {most['temporaries']} temporaries are the most of any", self.words)
        self.assertIn(f"all {sum(int(row['programs']) for row in self.rows)} texts", self.words)
        self.assertIn(f"{fitting} of {len(self.rows)} fit", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
        for name, most in chip_code.LIMITS.items():
            self.assertIn(f"| {name.replace('_', '-')} | {most} |", self.section)

    def test_shares_of_the_papers_machine_follow(self):
        stars = [f"star, paper profile, {rule}" for rule in ("SD", "CG")]
        slots, operations = [[float(self.cells(self.section, star, 3)[column]) for star in stars] for column in (0, 2)]
        draws = [float(self.cells(self.above, star, 3)[2].split(" → ")[1].replace(",", "")) for star in stars]
        more_slots, more_draws = slots[1] / slots[0], draws[1] / draws[0]
        more_operations = operations[1] / operations[0]
        self.assertIn(f"{more_slots:.1f} times SD's slots, and {more_operations:.1f} times its declared operations", self.words)
        parts = 0.2 * 2, 0.5 * more_draws, 0.3 * more_slots
        streams, switches, computes = (100 * part / sum(parts) for part in parts)
        machine = "From SD's 20, 50 and 30 %, twice the images"
        self.assertIn(f"{machine}, {more_draws:.2f} times the draws and {more_slots:.2f} times the slots, "
                      f"CG comes to {streams:.1f} % streaming, {switches:.0f} % switching and {computes:.0f} % computation", self.words)
        self.assertFalse(56 <= switches <= 76 and 4 <= computes <= 24)  # the bounds of C23
        claims = json.loads((ROOT / "results/reference/claims.json").read_text(encoding="utf-8"))["claims"]
        declared = next(claim for claim in claims if claim["id"] == "C23" and claim["profile"] == "paper")["measures"]
        of = {measure["of"].partition(";")[0]: 100 * measure["value"] for measure in declared}
        shares = [of[f"CG, {part}"] for part in ("streaming", "switching", "computation")]
        self.assertIn("it is {:.0f}, {:.0f} and {:.0f} %.".format(*shares), self.words)


class Rewriting(unittest.TestCase):
    def test_precise_sums_keep_their_operations(self):
        stage = ['OpName %main "main"', "OpDecorate %sum NoContraction", "OpDecorate %of_b NoContraction",
                 "OpDecorate %taken NoContraction", "%main = OpFunction %void None %3", "%sum = OpFAdd %float %a %b",
                 "%of_b = OpFSub %v2float %c %d", "%product = OpFMul %float %a %b", "%taken = OpFAdd %float %product %b",
                 "%free = OpFSub %float %sum %a"]  # fmt: skip
        hidden = spirv_to_floats.hide_sums("\n".join(stage)).splitlines()
        self.assertEqual(hidden[0], 'OpName %one "one"')
        self.assertIn("%one = OpVariable %to_one UniformConstant", hidden[: hidden.index(stage[4])])
        for line in ("%times_one_0 = OpFMul %float %a %one_0", "%sum = OpFAdd %float %times_one_0 %b",
                     "%times_one_1 = OpVectorTimesScalar %v2float %c %one_1", "%of_b = OpFSub %v2float %times_one_1 %d", *stage[7:]):
            self.assertIn(line, hidden)
        unhidden = "\n".join(stage[4:]) + "\n"
        self.assertEqual(spirv_to_floats.hide_sums(unhidden), unhidden)

    def test_results_that_tell_nothing_do_not_count(self):
        for written in ([0.0] * 4, [1.0, float("nan"), 0.0, 0.0], [float("inf"), 1.0, 1.0, 1.0]):
            self.assertFalse(interpret.tells(written))
        self.assertTrue(interpret.tells([0.0, -1.0, 0.0, 0.0]))
        self.assertTrue(interpret.same([1.0], [1.0 + 1e-9], 1e-6))
        self.assertFalse(interpret.same([1.0], [1.0 + 1e-9], 0))
        self.assertFalse(interpret.same([1.0], [float("nan")], 1e-6))


if __name__ == "__main__":
    unittest.main()
