"""Runs of experiments, as compare reads them: run.json and rows."""
from bad_inputs.damage import GONE, append, cut, fifo, field, folder, link, loop, remove, replace, unreadable, write

rows = []
record, errors = "runs/b/run.json", "runs/b/errors.csv"
again = "run the experiment again"
both = "compare runs/a runs/b"

rows += [
    (both, None, 0, "fig9_error: abc of 2024-01-01T00:00:00Z, then abc", "2 SAME"),
    (both, replace(errors, "22.5", "22.5001"), 0, "in all: "),
]

# The command
rows += [
    ("compare", None, 2, "before is required", "--help"),
    ("compare runs/a", None, 2, "after is required", "--help"),
    (f"{both} runs/b", None, 2, "'runs/b' is one argument too many"),
    ("compare '' runs/b", None, 2, "before = '': give a name"),
    ("compare runs/a nowhere", None, 2, "nowhere: no such folder; check the path"),
    ("compare runs/a/errors.csv runs/b", None, 2, "runs/a/errors.csv is no archive that radiafit-bench --all wrote; check the path"),
    ("compare runs/a photos", None, 2, "photos: no run in it or up to three folders down; name a folder with a run.json"),
    ("compare runs/a " + "n" * 300, None, 2, "n" * 300),
    ("compare runs/a around", loop("around"), 2, "around"),
    ("compare runs/a runs/other", None, 2, "runs/a and runs/other: no experiment has runs in both", "fig9_error (smoke", "scaling (smoke"),
    ("compare runs runs --only fig8", None, 2, "no experiment named like 'fig8' has runs in both", "the first holds none"),
    ("compare runs runs --only fig9", None, 0, "in all: "),
    (f"{both} --al", None, 2, "option '--al' does not exist", "nearest is --all"),
]

# run.json
for damage in (write(record, ""), write(record, "[]"), write(record, "no JSON"), write(record, "[" * 100000), cut(record, 0.5)):
    rows.append((both, damage, 2, f"{record}: no JSON object", again))
for name in ("program", "utc_start", "git_revision", "profile", "compiler", "cpu"):
    rows.append((both, field(record, name, GONE), 2, f"{record}: '{name}' is missing or no text", again))
    rows.append((both, field(record, name, 5), 2, f"{record}: '{name}' is missing or no text", again))
for name in ("cores", "threads"):
    rows.append((both, field(record, name, GONE), 2, f"{record}: '{name}' is missing or no whole number", again))
    rows.append((both, field(record, name, "two"), 2, f"{record}: '{name}' is missing or no whole number", again))
rows += [
    (both, field(record, "config", []), 2, f"{record}: 'config' is missing or no object", again),
    (both, field(record, "gl", {}), 2, f"{record}: 'renderer' is missing or no text", again),
    (both, remove(record), 2, "runs/b: rows without their run.json", again),
    (both, folder(record), 2, f"{record}: cannot read this record of a run: it is a folder"),
    (both, fifo(record), 2, f"{record}: cannot read this record of a run: it is a pipe"),
    (both, unreadable(record), 2, f"{record}: cannot read this record of a run", "check its permissions"),
    (both, unreadable("runs/b"), 2, "runs/b", "permission"),
    (both, link(record, "nowhere"), 2, "runs/b: rows without their run.json", again),
    (both, field(record, "program", "fig99"), 2, "no experiment has runs in both", "fig99 (smoke"),
    (both, [field("runs/a/run.json", "program", "fig99"), field(record, "program", "fig99")], 2,
     "runs/a/errors.csv: no rules for this file of fig99; say what its columns are in experiments/rows"),
]

# Rows
for size in (-1, -5, 0.4, 0.6, 0.9):
    rows.append((both, cut(errors, size), 2, f"{errors}: no line break behind the last row, so it may have been cut", "remake"))
rows += [
    (both, write(errors, ""), 2, f"{errors}: empty; remake it"),
    (both, write(errors, "\n"), 2, f"{errors}: "),
    (both, append(errors, "star\n"), 2, f"{errors}:4: 1 fields under 5 names; correct or remake the file"),
    (both, append(errors, '"star\n'), 2, f"{errors}:4: a quote is never closed"),
    (both, append(errors, "star,mean,1,20,0.2\n"), 2, f"{errors}: two rows of 'star, mean, 1'; remake the file"),
    (both, replace(errors, "seconds", "speed"), 2, f"{errors}: column 'speed' of fig9_error has no rule; say what it is in experiments/rows"),
    (both, replace(errors, "seconds", "terms"), 2, f"{errors}: column 'terms' appears twice; remake the file"),
    (both, replace(errors, "seconds", ""), 2, f"{errors}: column '' of fig9_error has no rule"),
    (both, replace(errors, "terms", "iterations"), 2, f"{errors}: no column 'terms', by which rows of runs/a/errors.csv are told apart", again),
    (both, replace(errors, "22.5", "bad"), 2, f"{errors}:3: 'bad' in column 'train_psnr_db' is no number"),
    (both, replace(errors, "0.1", "soon"), 2, f"{errors}:2: 'soon' in column 'seconds' is no number"),
    (both, replace(errors, "0.1", "inf"), 0, "UNCLEAR"),
    (both, replace(errors, "0.1", "-3"), 0, "UNCLEAR"),
    (both, write("runs/b/more.csv", "a\n1\n"), 2, "runs/b/more.csv: no rules for this file of fig9_error"),
    (both, write("runs/b/errors.md", "| a |"), 0, "in all: "),
    (both, folder(errors), 2, f"{errors}: cannot read this file of rows: it is a folder"),
    (both, fifo(errors), 2, f"{errors}: cannot read this file of rows: it is a pipe"),
    (both, unreadable(errors), 2, f"{errors}: cannot read this file of rows", "check its permissions"),
]
