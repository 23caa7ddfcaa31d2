#!/usr/bin/env python3
"""docs/article/fill.py over made-up claims and rows, and over the reference; scripts/replicate."""
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
ARTICLE = ROOT / "docs/article"
RUNS = "results/reference"
OLD, NEW = f"{RUNS}/timing/machine-a/20260101T000000Z-aaaa", f"{RUNS}/timing/machine-b/20260202T000000Z-bbbb"


def claim(id, verdict, run=NEW, profile="paper", **more):
    return {"id": id, "section": "6", "paper": f"what {id} is", "rule": "a rule", "profile": profile, "verdict": verdict,
            "reason": "", "sentence": f"{id} came to 1_000 * 2.", "measures": [], "renderer": "r", "run": run, **more}  # fmt: skip


class Article(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-article-"))
        self.addCleanup(shutil.rmtree, self.root)

    def fill(self, status=0):
        shutil.rmtree(self.root / "build", ignore_errors=True)
        done = subprocess.run([sys.executable, "-B", str(ARTICLE / "fill.py"), "--root", str(self.root)], capture_output=True,
                              text=True, check=False)  # fmt: skip
        self.assertEqual(done.returncode, status, done.stderr)
        if status:
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertFalse((self.root / "build").exists())
            return done.stderr
        self.assertEqual(done.stderr, "")
        return (self.root / "build/article/article.md").read_text(encoding="utf-8")


class MadeUp(Article):
    def setUp(self):
        super().setUp()
        (self.root / "docs/article").mkdir(parents=True)
        (self.root / "docs/article/metadata.yaml").write_text('author: "{{authors()}}"\n', encoding="utf-8")
        (self.root / "CITATION.cff").write_text("authors:\n  - name: A\n  - name: B\nreferences: []\n", encoding="utf-8")
        for folder, rate in ((OLD, 1), (NEW, 2)):
            path = self.root / folder
            path.mkdir(parents=True)
            (path / "run.json").write_text(json.dumps({"program": "timing", "profile": "paper", "config": {"cap": 3000}}))
            (path / "rows.csv").write_text(f'solver,seconds,empty\n"a, b",{rate * 0.0123456},\nc,{rate * 1234567.8},\n')
            (path / "packed.csv.gz").write_bytes(gzip.compress(b"share\n0.5\n0.25\n"))
        self.claims(claim("C1", "holds"))

    def claims(self, *claims):
        (self.root / RUNS / "claims.json").write_text(json.dumps({"format": "radiafit-claims", "claims": claims}))

    def filled(self, text):
        (self.root / "docs/article/article.md").write_text(text + "\n", encoding="utf-8")
        return self.fill().split("---\n\n", 1)[1].removesuffix("\n")

    def refused(self, text, *says):
        (self.root / "docs/article/article.md").write_text("first\n\n" + text + "\n", encoding="utf-8")
        said = self.fill(status=2)
        for words in says:
            self.assertIn(words, said)

    def test_the_metadata_have_the_authors(self):
        self.filled("")
        self.assertIn('author: "A and B"\n', (self.root / "build/article/article.md").read_text())

    def test_numbers_have_digits_and_a_mark_of_their_file(self):
        a = 'paper.timing.rows(solver="a, b").seconds'
        self.assertEqual(self.filled(f"takes {{{{{a}}}}} s, all"), "takes 0.0247^[r1](#r1)^ s, all".replace("0.0247^[r1](#r1)^ s", "0.0247 s^[r1](#r1)^"))
        for how, text in (("as 1", "0.02"), ("as %", "2.47 %"), ("as %1", "2 %"), ("as +.3f", "+0.025"), ("as .1f", "0.0")):
            self.assertEqual(self.filled(f"{{{{{a} {how}}}}}"), f"{text}^[r1](#r1)^")
        self.assertEqual(self.filled('{{-paper.timing.rows(solver="c").seconds as ,}}'), "−2,469,136^[r1](#r1)^")
        self.assertEqual(self.filled("{{paper.timing.config['cap']}}"), "3,000")

    def test_packed_rows_and_several(self):
        text = self.filled('{{mean(paper.timing.packed.all("share")) as %}} and {{len(paper.timing.rows)}}.\n\n{{sources()}}')
        self.assertEqual(text, "37.5 %^[r1](#r1)^ and 2^[r2](#r2)^.\n\n"
                               "- []{#r1}r1: `timing/machine-b/20260202T000000Z-bbbb/packed.csv.gz`\n"
                               "- []{#r2}r2: `timing/machine-b/20260202T000000Z-bbbb/rows.csv`")  # fmt: skip

    def test_a_table_has_its_marks_in_the_caption(self):
        self.assertEqual(self.filled("| a |\n|---|\n| {{max(paper.timing.packed.all('share'))}} |\n\n: Caption."),
                         "| a |\n|---|\n| 0.500 |\n\n: Caption. Rows: [r1](#r1).")  # fmt: skip

    def test_rows_of_tables(self):
        self.assertEqual(self.filled('| a | b |\n|---|---|\n{{cells("x", (paper.timing.packed(share=0.5).share, "%"))}}\n\n: Caption.'),
                         "| a | b |\n|---|---|\n| x | 50 % |\n\n: Caption. Rows: [r1](#r1).")  # fmt: skip

    def test_definitions(self):
        self.assertEqual(self.filled("<!-- fill\ndef twice(x):\n\n    return 2 * x\n-->\n\n{{twice(4)}}"), "8")
        self.refused("<!-- fill\nnonsense\n-->\n", "article.md: its definitions: NameError")

    def test_a_run_that_was_cut_short_stands_behind_a_whole_one(self):
        path = self.root / NEW / "run.json"
        path.write_text(json.dumps({**json.loads(path.read_text()), "rounds_left_out": True}))
        self.assertEqual(self.filled('{{paper.timing.rows(solver="c").seconds as ,}}'), "1,234,568^[r1](#r1)^")
        shutil.rmtree(self.root / OLD)
        self.assertEqual(self.filled('{{paper.timing.rows(solver="c").seconds as ,}}'), "2,469,136^[r1](#r1)^")

    def test_a_claim_is_told_by_the_run_that_is_told_first(self):
        self.claims(claim("C1", "holds", OLD, told_first=True), claim("C1", "does not hold", told_first=False))
        self.assertEqual(self.filled("C1: {{C1.verdict}}."), "C1: holds.")

    def test_a_claim_is_told_by_its_newest_run_that_says_something(self):
        self.claims(claim("C1", "holds", OLD), claim("C1", "does not hold"), claim("C1", "undecided", profile="standard"),
                    claim("C2", "holds", OLD), claim("C2", "not comparable"), claim("C3", "not run", ""),
                    claim("C4", "undecided", OLD), claim("C4", "undecided"))  # fmt: skip
        self.assertEqual(self.filled("C1: {{C1.verdict}}. C2: {{C2.verdict}}. C3: {{C3.verdict}}."),
                         "C1: does not hold. C2: holds. C3: not run.")  # fmt: skip
        self.assertEqual(self.filled("{{claims.count}}: {{claims.counted}}; {{claims.of('undecided')}}, {{claims.of('not comparable')}}"),
                         "4: 1 holds, 1 does not hold, 1 is undecided and 1 was not run; C4, none")  # fmt: skip
        self.assertEqual(self.filled("{{claims.machines}}"), "for C4 the verdict is the same, for C1 it differs")
        self.assertEqual(self.filled("C1 {{C1.sentence}} {{C1.run.config['cap']}}"), "C1 C1 came to 1\\_000 \\* 2. 3,000")
        self.refused("C3: {{C3.run.config}}", "no run that C3 is judged from")

    def test_former_rules_and_other_readings(self):
        self.claims(claim("C1", "holds", rule_is_younger_than_rows=True, readings=[{"name": "as mathematics", "verdict": "undecided"}],
                          former=[{"until": "2026-01-01", "verdict": "does not hold"}, {"until": "2025-01-01", "verdict": "holds"}]))  # fmt: skip
        told = "**holds**; as mathematics: undecided; by the rule until 2026-01-01: does not hold"
        self.assertEqual(self.filled("C1 {{C1.told}}. {{claims.younger}}"), f"C1 {told}. C1")
        self.assertIn(f"| {told} |", self.filled("{{claims.table}}"))

    def test_reasons(self):
        self.claims(*(claim(f"C{i}", "undecided", reason="too few") for i in (1, 2)), claim("C3", "holds"))
        self.assertEqual(self.filled("{{claims.reasons}}"), "- C1 and C2, undecided: too few.")

    def test_what_has_no_value_is_refused_in_one_line(self):
        for placeholder, says in (
            ("C9.verdict", "claims.json has no C9"), ("C1.colour", "claims.json has no colour of C1"),
            ("paper.nothing.rows", "no run of nothing at the paper profile"), ("standard.timing.rows", "no run of timing at the standard"),
            ("paper.timing.times", "has no times.csv, and its run.json no times"),
            ("paper.timing.rows(solver='x').seconds", "rows.csv has no row with solver = x"),
            ("paper.timing.rows(colour='x').seconds", "has no column colour"), ("paper.timing.rows(solver='c').colour", "has no column colour"),
            ("paper.timing.rows(solver='c').empty", "has no value in column empty"), ("paper.timing.rows.seconds", "has 2 rows for seconds"),
            ("paper.timing.rows(solver='c').solver as %", "no number"), ("1e400", "no number"), ("None", "no number"), ("''", "no value"),
            ("nonsense", "NameError"), ("1 +", "SyntaxError"), ("1 / 0", "ZeroDivisionError"),
            ("sure(1 > 2)", "write the sentence anew"),
        ):  # fmt: skip
            with self.subTest(placeholder):
                self.refused(f"C1, C9:\n{{{{{placeholder}}}}}", f"docs/article/article.md:4: {{{{{placeholder}}}}}: ", says)

    def test_a_paragraph_names_its_claims(self):
        self.refused("It {{C1.verdict}}.", "article.md:3: {{C1.verdict}}: the paragraph does not name C1")

    def test_a_verdict_without_a_word_is_refused(self):
        self.claims(claim("C1", "perhaps"))
        self.refused("{{claims.counted}}", "no word here: perhaps")

    def test_what_the_rows_bear_out_leaves_nothing(self):
        self.assertEqual(self.filled("All{{sure(2 > 1)}}, or {{len(paper.timing.packed)}}{{sure(f(1, 2))}}.".replace("f(1, 2)", "max(1, 2) == 2")),
                         "All, or 2^[r1](#r1)^.")  # fmt: skip


class OurOwn(Article):
    """The article itself, over the reference."""

    def setUp(self):
        super().setUp()
        (self.root / RUNS).mkdir(parents=True)
        (self.root / "docs").mkdir()
        for path in (*(ROOT / RUNS).iterdir(), ARTICLE, ROOT / "CITATION.cff"):
            if path.name != "claims.json":
                (self.root / path.relative_to(ROOT)).symlink_to(path)
        self.claims = json.loads((ROOT / RUNS / "claims.json").read_text())

    def fill(self, status=0):
        (self.root / RUNS / "claims.json").write_text(json.dumps(self.claims))
        return super().fill(status)

    def test_everything_is_filled(self):
        text = self.fill()
        self.assertNotRegex(text, r"\{\{|\}\}|\bnan\b|\bNone\b")
        self.assertEqual(set(re.findall(r"\(#(r\d+)\)", text)), set(re.findall(r"\[\]\{#(r\d+)\}", text)))
        declared = {chr(int(code, 16)) for code in re.findall(r"DeclareUnicodeCharacter\{(\w+)\}", (ARTICLE / "preamble.tex").read_text())}
        known = declared | {chr(code) for code in range(0xA0, 0x100)} | set("–—‘’“”…•")
        self.assertEqual({c for c in text if ord(c) > 126} - known, set(), "preamble.tex has to declare these")

    def test_it_can_be_read_whatever_the_verdicts_are(self):
        for verdict in ("holds", "does not hold", "undecided", "not comparable", "not run"):
            for one in self.claims["claims"]:
                one.update(verdict=verdict, rule_is_younger_than_rows=True, former=[{"until": "2026-01-01", "verdict": "holds"}],
                           readings=[{"name": "as told", "verdict": "undecided"}], reason="a reason")  # fmt: skip
            self.assertIn("23 ", self.fill())

    def test_no_verdict_is_typed_in(self):
        text = re.sub(r"\{\{.*?\}\}", "", (ARTICLE / "article.md").read_text(), flags=re.S)
        told = re.findall(r"\bC\d+\b[^.]{0,60}\b(?:holds|does not hold|hold|undecided|not comparable)\b", text)
        self.assertEqual(told, [])

    def test_the_makefile_builds_what_draws_its_figures(self):
        text, rules = (ARTICLE / "article.md").read_text(), tomllib.loads((ROOT / "experiments/claims/rules.toml").read_text())
        drawn = re.findall(r"figure\(paper\.(\w+)\)", text)
        drawn += [rules[claim]["experiment"] for claim in re.findall(r"figure\((C\d+)\.run\)", text)]
        recipe = re.search(r"^article:\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.M)[1]
        self.assertEqual(sorted(drawn), sorted(re.search(r"--target (.+)", recipe)[1].split()))


class OneFigure(unittest.TestCase):
    """Each script of scripts/replicate, with a made-up make."""

    def test_one_command_each(self):
        with tempfile.TemporaryDirectory() as folder:
            make = pathlib.Path(folder, "make")
            make.write_text('#!/bin/sh\necho "make $*"\n')
            make.chmod(0o755)
            scripts = [p for p in sorted((ROOT / "scripts/replicate").glob("*.sh")) if p.name != "common.sh"]
            self.assertEqual([p.stem for p in scripts], ["fig10", "fig7", "fig8", "fig9", "table1"])
            for script in scripts:
                for profile, figures in (("standard", "paper_figs"), ("smoke", "paper_figs/smoke")):
                    done = subprocess.run([script], cwd="/", capture_output=True, text=True, check=True, stdin=subprocess.DEVNULL,
                                          env={"PATH": f"{folder}:{os.environ['PATH']}", "RADIAFIT_SKIP_PACKAGES": "1", "PROFILE": profile})  # fmt: skip
                    command, place = done.stdout.splitlines()
                    (name,) = re.findall(r"^make experiments ONLY=(\w+)$", command)
                    self.assertTrue((ROOT / f"experiments/{name}.toml").exists(), name)
                    self.assertTrue(name.startswith(f"{script.stem}_"), name)
                    self.assertRegex(place, rf": {re.escape(str(ROOT))}/{figures}/{name}\.(png|md)$")


if __name__ == "__main__":
    unittest.main()
