#!/usr/bin/env python3
"""Judges the claims anew from results/reference, after rows were added there: writes results/reference/claims.json, the table of
docs/claims.md (of each claim the line that is told first), and README's counts. What changed is for the committer to read.
Usage: scripts/judge-reference.py [BUILD]      the build folder with experiments/claims in it; build/release"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
OLDER = "these rows are older than the rule"


def judged(program):
    """claims.json and claims.md over a copy of the reference, whose runs are then named as in any other checkout."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name in ("experiments", "paper_figs"):
            (root / name).mkdir()
        shutil.copy(ROOT / "experiments/claims.toml", root / "experiments")
        shutil.copytree(ROOT / "results/reference", root / "results/reference")
        subprocess.run([program, "--config", "experiments/claims.toml", "--set", 'results="results/reference"', "--output", "judged"],
                       cwd=root, check=True, capture_output=True)  # fmt: skip
        return (root / "judged/claims.json").read_text(), (root / "judged/claims.md").read_text()


def by_machine(told):
    """Which machine and which revision each claim's rows are of, in a sentence."""
    claims = {}
    for claim, row in told.items():
        about = json.loads((ROOT / row["run"] / "run.json").read_text())
        family = re.search(r"family \d+ model \d+", about["machine"].get("cpu_id", ""))
        name = re.sub(r"\((R|TM|family[^)]*)\)| Processor|@.*", "", about["cpu"]).strip()
        name = f"{name} ({family[0]})" if family else name
        claims.setdefault(f"{name} at {about['git_revision'][:8]}", []).append(claim)
    return "; ".join(f"{', '.join(ids)} by an {name}" for name, ids in claims.items())


def replaced(path, pattern, text):
    before = path.read_text(encoding="utf-8")
    after, count = re.subn(pattern, lambda _: text, before, flags=re.S)
    if count != 1:
        sys.exit(f"{path}: {count} places look like {pattern}; expected one")
    path.write_text(after, encoding="utf-8")


def main():
    build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release").resolve()
    verdicts, report = judged(build / "experiments/claims")
    (ROOT / "results/reference/claims.json").write_text(verdicts, encoding="utf-8")
    told = {row["id"]: row for row in json.loads(verdicts)["claims"] if row["told_first"]}
    lines = [" ".join(line.split()) for line in report.splitlines() if re.match(r"\| C\d+ ", line)]
    table = []
    for claim, row in told.items():
        sentence = " ".join(row["sentence"].split())
        own = [line for line in lines if line.startswith(f"| {claim} |") and sentence in line
               and (OLDER in line) == row["rule_is_younger_than_rows"]]  # fmt: skip
        if not own:
            sys.exit(f"claims.md has no line of {claim} that says: {sentence}")
        table.append(own[0])
    if len(told) != 23:
        sys.exit(f"{len(told)} claims are judged, not 23")
    replaced(ROOT / "docs/claims.md", r"(?<=\n)\| C1 \|.*\| C23 \|[^\n]*\n", "\n".join(table) + "\n")
    replaced(ROOT / "docs/claims.md", r"By machine(?: and revision)?: [^\n]*\n", f"By machine and revision: {by_machine(told)}.\n")
    found = [row["verdict"] for row in told.values()]
    hold, fail, undecided = (found.count(v) for v in ("holds", "does not hold", "undecided"))
    waiting = 23 - hold - fail - undecided
    counts = f"of 23, {hold} hold, {fail} do not, {waiting} {'waits' if waiting == 1 else 'wait'} for a graphics chip or for rows of their own"
    counts += f", and undecided {'is' if undecided == 1 else 'are'} {undecided}"
    replaced(ROOT / "README.md", r"of 23, \d+ hold, \d+ do not, \d+ waits? for [a-z ]+, and undecided (is|are) \d+", counts)
    older = sum(row["rule_is_younger_than_rows"] for row in told.values())
    still = f"; {older} of the verdicts are still of rows older than their rule, and say so" if older else ""
    replaced(ROOT / "README.md", r"(?<=\nformer rules)(; \d+ of the verdicts[^.]*)?(?=\.\n)", still)
    print(f"{counts}; {older} by rows older than their rule")
    print("now: python3 -B tests/check_figures.py --write && git diff")


if __name__ == "__main__":
    main()
