"""`solve`: models' texts, tables and arrays."""
import struct

from bad_inputs.damage import append, cut, folder, patch, remove, replace, write
from bad_inputs.fixtures import npy

rows = []
start = "--start slope=1,offset=0"
text, table = "sets/line.glsl", "sets/lines.csv"
solve_table = f"solve {table} --model {text} -o new {start}"
solve_arrays = f"solve sets/even --model {text} -o new {start}"
solve_ragged = f"solve sets/ragged --model {text} -o new {start}"

for good in (solve_table, solve_table + " --optimizer cg --memory 1K", solve_table + " --optimizer adam --learning-rate 1",
             solve_table + " --shard 2/2", solve_arrays, solve_ragged, solve_arrays + " --precision float", solve_table + " --loss huber --fix offset",
             f"solve sets/started --model {text} -o new"):
    rows.append((good, None, 0, "problems in"))

# The command
rows += [
    (f"solve {table} -o new {start}", None, 2, "--model is required"),
    (f"solve {table} --model {text} {start}", None, 2, "--output is required"),
    (f"solve --model {text} -o new {start}", None, 2, "problems is required"),
    (f"solve {table} --model {text} -o sets {start}", None, 2, "sets: ", "choose another name"),
    (f"solve {table} --model {text} -o new", None, 2, f"{table}: says not where fits begin in slope, offset", "--start slope=VALUE,offset=VALUE"),
    (f"solve {table} --model {text} -o new --start slope=1", None, 2, "begin in offset"),
    (f"solve {table} --model {text} -o new --start slope", None, 2, "start = 'slope': write NAME=VALUE"),
    (f"solve {table} --model {text} -o new --start slop=1,offset=0", None, 2, "slop", "slope, offset"),
    (f"solve {table} --model {text} -o new --start slope=one,offset=0", None, 2, "start slope = 'one'"),
    (f"solve {table} --model {text} -o new --start slope=nan,offset=0", None, 2, "start slope = nan"),
    (solve_table + " --lower slope=2 --upper slope=1", None, 2, "bounds of slope: from 2 to 1"),
    (solve_table + " --lower gain=2", None, 2, "gain", "slope, offset"),
    (solve_table + " --upper slope=high", None, 2, "upper slope = 'high'"),
    (solve_table + " --fix tilt", None, 2, "tilt", "slope, offset"),
    (solve_table + " --precision half", None, 2, "half", "double, float"),
    (solve_table + " --loss absolute", None, 2, "absolute", "huber"),
    (solve_table + " --loss-scale 0", None, 2, "loss-scale = "),
    (solve_table + " --iterations -1", None, 2, "iterations = "),
    (solve_table + " --tolerance 2", None, 2, "tolerance = "),
    (solve_table + " --optimizer newton", None, 2, "newton", "lbfgs"),
    (solve_table + " --optimizer lbfgs --learning-rate 0.1", None, 2, "--learning-rate is of --optimizer adam"),
    (solve_table + " --optimizer adam --learning-rate 0", None, 2, "learning-rate = "),
    (solve_table + " --optimizer adam --learning-rate nan", None, 2, "learning-rate = "),
    (solve_table + " --memory 0", None, 2, "memory '0': give bytes"),
    (solve_table + " --memory much", None, 2, "memory 'much': give bytes"),
    (solve_table + " --checkpoint -1", None, 2, "checkpoint = "),
    (solve_table + " --shard 3/2", None, 2, "shard '3/2'", "2/7"),
    (solve_table + " --shard 1", None, 2, "shard '1'", "2/7"),
    (solve_table + " --shard 1/9", None, 2, "--shard 1/9: there are 2 problems"),
    ("merge sets -o new", None, 2, "sets: no shard"),
    (f"solve sets/none --model {text} -o new {start}", None, 2, "sets/none: no such file or folder"),
    (f"solve {table} --model sets/none.glsl -o new {start}", None, 2, "sets/none.glsl"),
    ("CXX=none PATH=/nowhere " + solve_table, replace(text, "// A line.", "// Never compiled."), 2, "no C++ compiler", "g++"),
]  # fmt: skip

# The model's text
rows += [
    (solve_table, write(text, ""), 2, f"{text}: has no Terms"),
    (solve_table, replace(text, "struct Terms", "#include <x>\nstruct Terms"), 2, f"{text}:2: #include"),
    (solve_table, folder(text), 2, f"{text}: "),
    (solve_table, replace(text, "struct Terms", "struct Term"), 2, f"{text}: has no Terms"),
    (solve_table, replace(text, "struct Values", "struct Value"), 2, f"{text}: has no Values"),
    (solve_table, replace(text, "real slope", "float slope"), 2, f"{text}:3: members of Parameters are of type `real`"),
    (solve_table, replace(text, "slope, offset", "slope offset"), 2, f"{text}:3: expected `,` or `;` behind slope"),
    (solve_table, replace(text, "slope, offset", "slope, slope"), 2, f"{text}:3: Parameters has two members slope"),
    (solve_table, replace(text, "real x;", ""), 2, f"{text}:2: Terms has no members"),
    (solve_table, replace(text, "Values value", "Values val"), 2, f"{text}: has no function"),
    (solve_table, replace(text, "p.offset", "p.start"), 2, f"{text}:6: ", "start"),
    (solve_table, replace(text, "p.slope", "slope"), 2, f"{text}:6: ", "slope"),
    (solve_table, replace(text, "return", "retrun"), 2, f"{text}:6: "),
    (solve_table, cut(text, -4), 2, f"{text}"),
    (solve_table, replace(text, "real x;", "real time;"), 2, f"{table}:1: no column 'time'", "problem, x, y"),
]

# Tables
rows += [
    (solve_table, write(table, ""), 2, f"{table}: empty"),
    (solve_table, write(table, "problem,x,y\n"), 2, f"{table}: no rows"),
    (solve_table, replace(table, "problem,x,y", "problem,x,z"), 2, f"{table}:1: no column 'y'"),
    (solve_table, replace(table, "a,1,3", "a,1"), 2, f"{table}:3: 2 fields, where there are 3 columns"),
    (solve_table, replace(table, "a,1,3", "a,1,3,4"), 2, f"{table}:3: 4 fields"),
    (solve_table, replace(table, "a,1,3", '"a",1,"3'), 2, f"{table}:3: a quote is never closed"),
    (solve_table, replace(table, "a,1,3", '"a",1,"3"'), 0, "2 problems in"),
    (solve_table, replace(table, "a,1,3", '"a, b",1,3'), 0, "3 problems in"),
    (solve_table, replace(table, "a,1,3", "a,one,3"), 2, f"{table}:3: ", "one"),
    (solve_table, replace(table, "a,1,3", "a,1,inf"), 2, f"{table}:3: ", "inf"),
    (solve_table, replace(table, "a,1,3", "a,1,nan"), 0, "problems in"),
    (solve_table, replace(table, "a,1,3", "a,1,"), 0, "problems in"),
    (solve_table, replace(table, "a,1,3", "a,1,3\0"), 2, f"{table}"),
    (solve_table + " --precision float", replace(table, "a,1,3", "a,1,1e60"), 2, f"{table}:3: y = 1e+60 is beyond what floats hold"),
    (solve_table, replace(table, "a,1,3", "#a,1,3"), 0, "3 problems in"),
    (solve_table, remove(table), 2, f"{table}: no such file or folder"),
]

# Arrays
for array in ("terms", "targets"):
    file = f"sets/even/{array}.npy"
    rows += [
        (solve_arrays, remove(file), 2, f"{file}: missing {array}"),
        (solve_arrays, folder(file), 2, f"{file}: "),
        (solve_arrays, write(file, ""), 2, f"{file}: no array of numpy.save"),
        (solve_arrays, write(file, "x,y\n1,2\n"), 2, f"{file}: no array of numpy.save"),
        (solve_arrays, cut(file, -1), 2, f"{file}: cut", "copy it again", "numpy.save"),
        (solve_arrays, cut(file, 40), 2, f"{file}: its header is damaged"),
        (solve_arrays, replace(file, "<f8", ">f8"), 2, f"{file}: big-endian", "astype"),
        (solve_arrays, replace(file, "<f8", "<c8"), 2, f"{file}: elements of type '<c8'", "float64"),
        (solve_arrays, replace(file, "<f8", "|O8"), 2, f"{file}: elements of type '|O8'"),
        (solve_arrays, replace(file, "False", "True "), 0, "problems in"),
        (solve_arrays, replace(file, "'shape': \\(", "'shape': (x"), 2, f"{file}: its shape is damaged"),
        (solve_arrays, replace(file, "'shape': \\(", "'shape': (99999999999999999, 99999999999, "), 2, f"{file}: "),
    ]
eight = struct.pack("<8d", *range(8))
rows += [
    (solve_arrays, write("sets/even/terms.npy", npy("<f8", (5,), eight[:40])), 2, "sets/even/terms.npy: its shape is (5,), which should be", "for x"),
    (solve_arrays, write("sets/even/targets.npy", npy("<f8", (8,), eight)), 2, "its shape is (8,)", "offsets"),
    (solve_arrays, write("sets/even/targets.npy", npy("<f8", (2, 2, 2), eight)), 2, "its shape is (2, 2, 2)", "for y"),
    (solve_arrays, write("sets/even/targets.npy", npy("<i2", (2, 4), struct.pack("<8h", *range(8)))), 0, "problems in"),
    (solve_arrays, write("sets/even/targets.npy", npy("|b1", (2, 4), bytes([0, 1] * 4))), 0, "problems in"),
    (solve_arrays, write("sets/even/weights.npy", npy("<f8", (2, 4), eight)), 0, "problems in"),
    (solve_arrays, write("sets/even/weights.npy", npy("<f8", (4,), eight[:32])), 2, "sets/even/weights.npy: its shape is (4,), which should be (2, 4)"),
    (solve_arrays, write("sets/even/weights.npy", npy("<f8", (2, 4), struct.pack("<8d", *range(-1, 7)))), 2, "weights.npy: -1 is below 0"),
    (solve_arrays, write("sets/even/weights.npy", npy("<f8", (2, 4), struct.pack("<8d", *[float("inf")] * 8))), 2, "weights.npy: inf is not finite"),
    (solve_arrays + " --precision float", write("sets/even/targets.npy", npy("<f8", (2, 4), struct.pack("<8d", *[1e-60] * 8))), 2, "sets/even/targets.npy: 1e-60 is beyond what floats hold"),
    (solve_arrays, write("sets/even/start.npy", npy("<f8", (3,), eight[:24])), 2, "sets/even/start.npy: its shape is (3,)", "slope, offset"),
    (solve_arrays, write("sets/even/start.npy", npy("<f8", (2, 2), eight[:32])), 0, "problems in"),
    (solve_arrays, write("sets/even/start.npy", npy("<f8", (2, 1, 2), eight[:32])), 0, "problems in"),
    (solve_arrays, write("sets/even/start.npy", npy("<f8", (0, 1, 2), b"")), 2, "sets/even/start.npy: its shape is (0, 1, 2)"),
    (f"solve sets/started --model {text} -o new", write("sets/started/start.npy", npy("<f8", (2,), struct.pack("<2d", 1, float("nan")))), 2, "begin in offset"),
    (f"solve sets/started --model {text} -o new", write("sets/started/start.npy", npy("<f8", (2, 2), struct.pack("<4d", 1, 1, 1, float("inf")))), 2, "offset of problem 1 is no finite number"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<i8", (3,), struct.pack("<3q", 0, 9, 5))), 2, "offsets.npy: number 2 is 5, less than"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<i8", (3,), struct.pack("<3q", 0, 2, 4))), 2, "sets/ragged/offsets.npy: ends with 4, where", "has 5 samples"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<i8", (3,), struct.pack("<3q", 1, 2, 5))), 2, "offsets.npy: begin with 1"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<i8", (1, 3), struct.pack("<3q", 0, 2, 5))), 2, "sets/ragged/offsets.npy: its shape is (1, 3)"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<i8", (0,), b"")), 2, "sets/ragged/offsets.npy: its shape is (0,)"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<f8", (3,), struct.pack("<3d", 0, 2, 5))), 2, "sets/ragged/offsets.npy: has fractions", "int64"),
    (solve_ragged, write("sets/ragged/offsets.npy", npy("<i4", (4,), struct.pack("<4i", 0, 2, 2, 5))), 0, "problems in"),
    (solve_ragged, append("sets/ragged/offsets.npy", "more"), 2, "sets/ragged/offsets.npy: too long: 28 bytes follow its header, not the 24 of its shape (3,)"),
    (solve_ragged, patch("sets/ragged/targets.npy", -8, struct.pack("<d", float("nan"))), 0, "problems in"),
]  # fmt: skip
