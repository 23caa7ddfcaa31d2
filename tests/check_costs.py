#!/usr/bin/env python3
"""Every fragment stage but those of the page (shaders/view) declares in src/core/fragment/pass_costs.cpp what one invocation costs, and the
declaration is what its SPIR-V holds.

The SPIR-V is glslc's, with calls inlined, loops of constant length unrolled and dead code removed by spirv-opt,
then counted as it stands: both sides of a branch count. What src/core/fragment/pass_costs.h says is counted:

  - operations: components of arithmetic, conversions, comparisons, selections and bit operations, addresses included; a
    multiply-add is two, a dot product of n components 2 n - 1; a division, a root or a transcendental function is one.
    Moves, constants and jumps are none.
  - reads: texels fetched; one fetched twice at the same place counts once. Bytes by the format behind each sampler.
  - targets: colours written.

Work in a loop whose length isn't constant is declared apart, per entry; around such a loop there may be one more, whose own
counter is left out. Definitions that a variant leaves open must not matter: each count is made twice, with other values.
Usage: check_costs.py [--write] [ROOT]. --write puts the counts into the table. Exit status 77 (skipped) without glslc and spirv-opt."""
import concurrent.futures
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import check_shaders  # noqa: E402

TABLE = "src/core/fragment/pass_costs.cpp"
ROW = re.compile(r'^ *\{"([\w/]+\.frag)", "([^"]*)", (\d+), \{([\d, ]*)\}, \{([\d, ]*)\}\},$', re.M)
# What a variant leaves open, with two values for each.
OPEN = {"VIEW_SIDE": (8, 16), "COLUMNS": (64, 37), "SIDE": (8, 11), "RECTANGLES": (64, 19), "ROWS": (64, 23), "BANDS": (5, 3),
        "ENTRIES": (15, 7), "SOURCE_SIDE": (8, 2), "TARGET_SIDE": (2, 1)}
# Bytes of a texel behind each sampler, of maps at STORAGE=0; all others are RGBA32F or RGBA32UI. Images have 8 bits a channel; those
# of shaders/reflect, in linear light, 16, as COLOUR=16 says elsewhere.
BYTES = {"drawn": 4, "image": 4, "items": 4}
BYTES_REFLECT = {"image": 8, "items": 4, "inverse_samples": 4, "penalties": 4, "lengths": 4}
BYTES_COLOUR = {"8": {"image": 4, "items": 8}, "16": {"image": 8, "items": 16}}
BYTES_REFLECT_COLOUR = {"8": {"image": 4, "images": 4, "taken": 4}, "16": {"image": 8, "images": 8, "taken": 8}}
# Operations per component of the result, where not one; of those below, per component of the operand.
OPERATIONS = {"Fma": 2, "FClamp": 2, "SClamp": 2, "UClamp": 2, "FMix": 3, "Normalize": 3, "Cross": 3}
OPERATIONS_OF_OPERAND = {"Length": 2, "Distance": 3}
EACH_COMPONENT = set("""
    SNegate FNegate IAdd FAdd ISub FSub IMul FMul UDiv SDiv FDiv UMod SRem SMod FRem FMod VectorTimesScalar
    ConvertFToU ConvertFToS ConvertSToF ConvertUToF UConvert SConvert FConvert
    ShiftRightLogical ShiftRightArithmetic ShiftLeftLogical BitwiseOr BitwiseXor BitwiseAnd Not
    LogicalEqual LogicalNotEqual LogicalOr LogicalAnd LogicalNot Select
    IEqual INotEqual UGreaterThan SGreaterThan UGreaterThanEqual SGreaterThanEqual ULessThan SLessThan ULessThanEqual
    SLessThanEqual FOrdEqual FUnordEqual FOrdNotEqual FUnordNotEqual FOrdLessThan FUnordLessThan FOrdGreaterThan
    FUnordGreaterThan FOrdLessThanEqual FUnordLessThanEqual FOrdGreaterThanEqual FUnordGreaterThanEqual IsNan IsInf""".split())
NOTHING = set("""
    Load Store AccessChain CompositeExtract CompositeConstruct CompositeInsert VectorShuffle VectorExtractDynamic
    VectorInsertDynamic CopyObject Bitcast Undef Image Phi Variable Label Branch BranchConditional SelectionMerge LoopMerge
    Return FunctionEnd Function Switch Unreachable ImageQuerySizeLod""".split())
TOOLS = ("glslc", "spirv-opt", "spirv-dis")


class CostError(Exception):
    pass


def run(label, *command):
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode:
        raise CostError(f"{label}: {command[0]}: {(result.stdout + result.stderr).strip()}")
    return result.stdout


def optimized(spirv, label):
    """The SPIR-V of a fragment stage in a file, optimized and disassembled."""
    words = list(struct.unpack(f"<{spirv.stat().st_size // 4}I", spirv.read_bytes()))
    at = 5
    while at < len(words):  # spirv-opt unrolls loops that ask for it
        if words[at] & 0xffff == 246:  # OpLoopMerge
            words[at + 3] |= 1
        at += words[at] >> 16
    spirv.write_bytes(struct.pack(f"<{len(words)}I", *words))
    short = spirv.with_suffix(".short")
    run(label, "spirv-opt", "--target-env=opengl4.5", "-O", "--loop-unroll", "-O", spirv, "-o", short)
    return run(label, "spirv-dis", short)


def components(type_name):
    vector = re.match(r"v([234])(float|double|int|uint|bool)$", type_name.lstrip("%"))
    return int(vector[1]) if vector else 1


def loop_depths(blocks, merges, label):
    """How many loops each block stands in. blocks: label -> (its lines, where it goes); merges: head -> the loop's end."""
    depth = dict.fromkeys(blocks, 0)
    for head, end in merges.items():
        inside, open_blocks = set(), [head]
        while open_blocks:
            block = open_blocks.pop()
            if block == end or block in inside:
                continue
            inside.add(block)
            open_blocks += blocks[block][1]
        for block in inside:
            depth[block] += 1
    if max(depth.values()) > 2:
        raise CostError(f"{label}: three loops inside one another; declare one of them constant")
    return depth


def bytes_of_texels(name, defines, text):
    """By sampler, of a stage's text with what it includes."""
    reflect = name.startswith("reflect/")
    sizes = dict(BYTES_REFLECT if reflect else BYTES)
    colour, batch = dict(defines).get("COLOUR"), dict(defines).get("BATCH")
    sizes.update((BYTES_REFLECT_COLOUR if reflect else BYTES_COLOUR).get(colour, {}))
    if batch:  # what texels keep of each image (shaders/combine/colours.glsl)
        sizes["colours"] = int(batch) * int(colour) // 2
    if dict(defines).get("STORAGE") in ("1", "2"):  # of halves
        sizes.update({sampler: 8 for sampler in re.findall(r"\buniform MAPS (\w+)", text)})
    return sizes


def count(disassembly, label, bytes_of):
    """(targets, [operations, reads, bytes], [the same per entry of a loop])"""
    blocks, merges, block, targets = {}, {}, None, 0
    kind_of, pointed, value, length, variable_of, place_of = {}, {}, {}, {}, {}, {}  # by identifier
    for line in disassembly.splitlines():
        match = re.match(r"\s*(?:(%\w+) = )?Op(\w+)\s*(.*)$", line)
        if not match:
            continue
        result, op, operands = match[1], match[2], match[3].split()
        if result and operands:
            kind_of[result] = operands[0]
        if op == "TypePointer":
            pointed[result] = operands[1]
        elif op == "Constant":
            value[result] = operands[1]
        elif op == "TypeArray":
            length[result] = int(value[operands[1]])
        elif op == "Variable" and operands[1] == "Output":
            targets += length.get(pointed[operands[0]], 1)
        elif op == "Label":
            block = result
            blocks[block] = ([], [])
        if block is None:
            continue
        blocks[block][0].append((result, op, operands))
        if op == "LoopMerge":
            merges[block] = operands[0]
        elif op == "Branch":
            blocks[block][1].append(operands[0])
        elif op == "BranchConditional":
            blocks[block][1].extend(operands[1:3])
        elif op == "Switch":
            raise CostError(f"{label}: a switch, which this count doesn't know")

    depths = loop_depths(blocks, merges, label)
    deepest = max(depths.values())
    work = {depth: [0, 0, 0] for depth in range(3)}
    fetched = set()
    for name, (lines, _) in blocks.items():
        here = work[depths[name]]
        for result, op, operands in lines:
            if op == "Load":
                variable_of[result], place_of[result] = variable_of.get(operands[1], operands[1]), operands[1]
            elif op == "AccessChain":
                variable_of[result] = operands[1]
            elif op == "Image":
                variable_of[result], place_of[result] = variable_of[operands[1]], place_of[operands[1]]
            if op == "ImageFetch":
                sampler = variable_of[operands[1]].lstrip("%")
                if (place_of[operands[1]], operands[2]) in fetched:
                    continue
                fetched.add((place_of[operands[1]], operands[2]))
                here[1] += 1
                here[2] += bytes_of.get(sampler, 16)
            elif op == "ExtInst":
                function, argument = operands[2:4]
                if function in OPERATIONS_OF_OPERAND:
                    here[0] += OPERATIONS_OF_OPERAND[function] * components(kind_of[argument])
                else:
                    here[0] += components(operands[0]) * OPERATIONS.get(function, 1)
            elif op == "Dot":
                here[0] += 2 * components(kind_of[operands[1]]) - 1
            elif op in ("Any", "All"):
                here[0] += components(kind_of[operands[1]]) - 1
            elif op in EACH_COMPONENT:
                here[0] += components(operands[0])
            elif op not in NOTHING:
                raise CostError(f"{label}: Op{op}, which this count doesn't know")
    if deepest == 2:
        if work[1][1] or work[1][0] > 12:
            raise CostError(f"{label}: work between two loops, {work[1][0]} operations and {work[1][1]} reads, has no place "
                            "in a declaration")
        return targets, work[0], work[2]
    return targets, work[0], work[1]


def given_by(variant):
    return [tuple((item.split("=", 1) + [""])[:2]) for item in variant.split()]


def count_rows(shaders, rows):
    """What each (stage, variant) costs, or the error why not. Compilers take long to start, so one gets all texts."""
    results, texts = {}, []
    for row in rows:
        try:
            for turn in range(2):
                defines = given_by(row[1]) + [(key, str(values[turn])) for key, values in OPEN.items()]
                texts.append((row, check_shaders.expand(shaders, row[0], defines)[0]))
        except check_shaders.ShaderError as error:
            results[row] = error
    with tempfile.TemporaryDirectory(prefix="radiafit-costs-") as folder:
        paths, said = check_shaders.compile_spirv([(text, "frag") for _, text in texts], folder)
        of_row, text_of = {}, dict(texts)
        for (row, _), path in zip(texts, paths):
            of_row.setdefault(row, []).append(path)
        for (name, variant), both in of_row.items():
            label = f"shaders/{name} [{variant}]"
            try:
                if None in both:
                    raise CostError(f"{label}: glslc: {said.strip()}")
                found = [count(optimized(path, label), label, bytes_of_texels(name, given_by(variant), text_of[name, variant]))
                         for path in both]
                if found[0] != found[1]:
                    raise CostError(f"{label}: {found[0]} or {found[1]}, depending on what the variant leaves open; "
                                    f"put it into the variant (pass_variant in {TABLE})")
                results[name, variant] = found[0]
            except CostError as error:
                results[name, variant] = error
    return [results[row] for row in rows]


def row_text(name, variant, cost):
    targets, once, entry = cost
    return '{"%s", "%s", %d, {%s}, {%s}},' % (name, variant, targets, ", ".join(map(str, once)),
                                            ", ".join(map(str, entry)) if any(entry) else "")


def check(root, write=False):
    shaders, table = root / "shaders", root / TABLE
    text = table.read_text(encoding="utf-8")
    rows = [(m[1], m[2], m[0].strip()) for m in ROW.finditer(text)]
    errors = []

    cores = len(os.sched_getaffinity(0))
    costs = {}
    with concurrent.futures.ThreadPoolExecutor(cores) as threads:  # each waits for its compiler
        parts = [part for part in (rows[core::cores] for core in range(cores)) if part]
        for part, found in zip(parts, threads.map(lambda part: count_rows(shaders, [row[:2] for row in part]), parts)):
            costs.update(zip((row[:2] for row in part), found))
    for name, variant, declared in rows:
        cost = costs[name, variant]
        if isinstance(cost, Exception):
            errors.append(str(cost))
            continue
        now = row_text(name, variant, cost)
        if now != declared and write:
            text = text.replace(declared, now)
        elif now != declared:
            errors.append(f"{TABLE} declares {declared}\n    its SPIR-V has    {now}")
    if write:
        table.write_text(text, encoding="utf-8")
    for path in sorted(shaders.rglob("*.frag")):
        name = path.relative_to(shaders).as_posix()
        if name.startswith("view/"):  # drawn by a browser, where no cost is reckoned
            continue
        if not any(row[0] == name for row in rows):
            errors.append(f"shaders/{name}: {TABLE} declares no cost of it; add a row for each variant that src/core/fragment "
                          "draws, with any numbers, and --write puts the right ones in")
    return errors, len(rows)


def main():
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if missing:
        print(f"skipped: {' and '.join(missing)} absent (scripts/install-packages.sh installs them)")
        return 77
    write, root = "--write" in sys.argv[1:], [a for a in sys.argv[1:] if a != "--write"]
    errors, rows = check(pathlib.Path(root[0]) if root else pathlib.Path(__file__).resolve().parent.parent, write)
    print("\n".join([*errors, "check_costs.py --write mends the table"]) if errors else f"{rows} declared costs are those of the SPIR-V")
    return 1 if errors or rows == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
