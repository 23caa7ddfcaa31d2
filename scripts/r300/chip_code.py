#!/usr/bin/env python3
"""What Mesa's compiler for the Radeon 9700 (r300) makes of each pass of --passes r300, with one term and images of 8 bits: arithmetic
slots, texture instructions, levels of look-ups and temporaries, and whether the chip could hold them (64, 32, 4 and 32). No such
chip is needed: the compiler runs on the one that mesa-drm-shim pretends. The first time FOLDER gets its packages, of whatever Mesa
Debian 12's backports have then (10 MB, unpacked there and nowhere else); mesa-25.0.7.csv is what 25.0.7 made, and another version may
make other programs. On another system the libraries that they ask for may be absent. glslc, spirv-as and spirv-opt are those of
scripts/install-packages.sh.

A stage goes the way that tests/check_costs.py counts it by, to SPIR-V without calls and loops, and spirv_to_floats.py writes it for a
chip without integers. What the host gives as integers are constants of the program, each value that it gives in turn; of these
programs the one with the most slots is told. Storage is 32 bits in the text; 16 bits are a format of textures, and no instructions.

A slot is an instruction on three channels and one on the fourth. Look-ups at coordinates that other instructions make begin a
level, of which the first has none before it. A program that is too long is counted as it was before it was refused.

Usage: chip_code.py FOLDER [--csv FILE] [--counts PASSES.CSV] [--check] [--only WORD] [--chip NAME] [--keep FOLDER]
    --csv      a row a pass: what pass_costs.cpp declares, and the longest of its programs
    --counts   passes.csv of fig10_utilization with passes=["r300"]: slots and look-ups of whole iterations
    --check    runs each stage and its rewritten text on inputs drawn at random; status 1 where they write other numbers, or never
               one that is finite and not 0. What the compiler makes of the text is not run
    --only     passes whose name and definitions have this in them
    --chip     which the shim pretends: R300_ND, the Radeon 9700, or another of its names
    --keep     where to leave the rewritten texts, and what the compiler says of them: a new folder, or an empty one"""
import argparse
import csv
import itertools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(ROOT / "tests"))
import check_costs  # noqa: E402
import check_shaders  # noqa: E402
import interpret  # noqa: E402
import spirv_to_floats  # noqa: E402

PACKAGES = ("mesa-drm-shim", "mesa-libgallium", "libegl-mesa0", "libgbm1", "libgl1-mesa-dri", "libdrm2", "libdrm-radeon1",
            "libdrm-amdgpu1", "libdrm-intel1")  # fmt: skip
MIRROR = os.environ.get("MIRROR", "http://deb.debian.org")
LIMITS = {"slots": 64, "look_ups": 32, "levels": 4, "temporaries": 32}
ENOUGH = 8  # different results of a program, to compare
COLUMNS = ("shader", "variant", "operations", "reads", *LIMITS, "programs", "fitting", "longest", "longest_fitting", "why")
MEASURED = HERE / "mesa-25.0.7.csv"  # by that version
GLSL = "130"  # for mix() of truth values; all else is of 1.20, which is the driver's own

# Integers that the host gives, with the values that it gives; `map` has those of the model's maps.
GIVEN = {"corner": (0, 1, 2), "term": (0,), "fitted": (1,), "rule": (0, 1, 2), "restart": (0, 1), "slot": (0,), "paper_penalty": (0, 1),
         "weighted": (0, 1), "to_16_bit": (257,)}  # fmt: skip
RULES = {"sd": 0, "cg": 1}  # optimizers of the paper: which rule they are
MAPS = {"lafortune": (0, 1, 2), "lambert": (0,)}
NUMBERS = {"update_direction": (5, 4, 0, 0), "advance": (9, 0, 0, 0)}  # which a problem's update takes: accepted, beta; taken
# Textures of one size, so that a place in one is at the same coordinates in another: those with a texel a vertex.
TEXTURE_SIZES = dict.fromkeys(("footprints", "ring_sums", "view_values", "view_slopes", "products", "sample_sums", "map_sums",
                               "problem_constants", "largest_diagonal"), "vertices")  # fmt: skip


def of_the_chip(name, variant, targets, loop):
    """Whether a row of pass_costs.cpp is a pass of --passes r300, with one term and images of 8 bits."""
    words = variant.split()
    if name.startswith(("combine/", "peaks/")) or name in ("gather/store.frag", "reflect/take.frag", "distribute/pixel_index.frag"):
        return False
    if targets != "1" or loop.strip() or {"STORAGE=1", "VALUES=1", "GRID", "COLOUR=16", "COLOUR=8"} & set(words):
        return False
    if name == "gather/scatter.frag":
        return "GATHERED" in words
    return name != "optimize/update.frag" or "WRITTEN=1" in words or "ONLY=" in variant


def passes():
    text = (ROOT / check_costs.TABLE).read_text(encoding="utf-8")
    return [(match[1], match[2], [int(n) for n in match[4].split(", ")]) for match in check_costs.ROW.finditer(text)
            if of_the_chip(match[1], match[2], match[3], match[5])]


def with_constants(text, variant):
    """The text once for each choice of the integers that the host gives: (choice, text)."""
    defines = dict(check_costs.given_by(variant))
    given = dict(GIVEN, map=MAPS.get(defines.get("MODEL"), (0,)))
    numbers = ", ".join(map(str, NUMBERS.get(defines.get("TEXT"), (0, 0, 0, 0))))
    text = re.sub(r"^uniform int number_indices\[MOST_REGISTERS\];", f"const int number_indices[4] = int[4]({numbers});", text, flags=re.M)
    names = re.findall(r"^uniform int (\w+);", text, re.M)
    for values in itertools.product(*(given.get(name, (0,)) for name in names)):
        one = text
        for name, value in zip(names, values):
            one = re.sub(rf"^uniform int {name};", f"const int {name} = {value};", one, flags=re.M)
        yield " ".join(f"{name}={value}" for name, value in zip(names, values) if len(given.get(name, (0,))) > 1), one


def differs(programs, folder, most=400):
    """Of each program in folder how often its rewritten text writes something else than the stage itself, on inputs drawn at random;
    and how many different results there were, finite and not all 0. Trials go on until there are enough of these. What is the same
    is so up to rounding in double and to what floats hold of bits. Sums of errors have a second float for what rounding takes from
    the first: those are rounded, and the same to the last bit."""
    with tempfile.TemporaryDirectory(prefix="radiafit-r300-") as spirv:
        texts = []
        for number in programs:
            text = (folder / f"{number}.frag").read_text()
            text = text.replace(f"#version {GLSL}", "#version 450 core\nlayout(location = 0) out vec4 colour;", 1)
            text = re.sub(r"^varying ", "in ", text, flags=re.M).replace("texture2D(", "texture(").replace("gl_FragColor", "colour")
            texts.append((text, "frag"))
        paths, said = check_shaders.compile_spirv(texts, spirv)
        counts, width = {}, check_costs.OPEN["SIDE"][0] * check_costs.OPEN["RECTANGLES"][0]
        for number, path in zip(programs, paths):
            if path is None:
                sys.exit(f"{number}: {said}")
            (shader, variant), _, stage = programs[number]
            sums = shader == "optimize/summary.frag"
            first = interpret.Program(stage, whole=True, rounds=sums)
            second = interpret.Program(check_costs.optimized(path, str(number)), whole=False, rounds=sums)
            different, written, trial, most_at = 0, set(), 0, 10 if sums else 40  # a sum is of a block of problems
            while trial < ENOUGH or (len(written) < ENOUGH and trial < most):
                trial += 1
                place = (int(interpret.drawn(number, trial, "x") * most_at), int(interpret.drawn(number, trial, "y") * most_at))
                scene = interpret.Scene(trial, f"{shader} {variant}", place, width)
                wanted, found = first.run(scene), second.run(scene)
                if sums:  # bits of floats
                    wanted = wanted[:2] + [interpret.float_of(bits) for bits in wanted[2:]]
                different += not interpret.same(wanted, found, 0 if sums else 1e-6)
                if interpret.tells(wanted):
                    written.add(tuple(wanted))
            counts[number] = different, len(written)
    return counts


def refuse(words):
    print(f"chip_code.py: {words}", file=sys.stderr)
    sys.exit(2)


def run(*command, **more):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if result.returncode:
        sys.exit(f"{command[0]}: {(result.stdout + result.stderr).strip()}")
    return result.stdout


def fetch(folder):
    """The compiler's packages, unpacked into folder/root."""
    root, apt, packages = folder / "root", folder / "apt", folder / "packages"
    if root.is_dir():
        return root
    for path in (apt / "state/lists/partial", apt / "cache/archives/partial", packages):
        path.mkdir(parents=True, exist_ok=True)
    key = "[signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]"
    (apt / "sources.list").write_text("".join(f"deb {key} {MIRROR}/debian {suite} main\n" for suite in ("bookworm", "bookworm-backports")))
    options = [f"-oDir::Etc::sourcelist={apt}/sources.list", "-oDir::Etc::sourceparts=/dev/null", f"-oDir::State={apt}/state",
               f"-oDir::Cache={apt}/cache", "-oDir::State::status=/var/lib/dpkg/status", "-oAPT::Sandbox::User="]  # fmt: skip
    run("apt-get", *options, "-qq", "update")
    run("apt-get", *options, "-qq", "download", *(f"{name}/bookworm-backports" for name in PACKAGES), cwd=packages)
    for package in sorted(packages.glob("*.deb")):
        run("dpkg", "-x", package, folder / "unpacked")
    (folder / "unpacked").rename(root)
    return root


def driver_environment(root, chip):
    libraries = next((root / "usr/lib").glob("*/libradeon_noop_drm_shim.so")).parent
    return dict(
        os.environ,
        LD_PRELOAD=str(libraries / "libradeon_noop_drm_shim.so"),
        LD_LIBRARY_PATH=str(libraries),
        LIBGL_DRIVERS_PATH=str(libraries / "dri"),
        GBM_BACKENDS_PATH=str(libraries / "gbm"),
        __EGL_VENDOR_LIBRARY_FILENAMES=str(root / "usr/share/glvnd/egl_vendor.d/50_mesa.json"),
        RADEON_GPU_ID=chip,
        RADEON_DEBUG="fp",
        MESA_GLSL_VERSION_OVERRIDE=GLSL,
        MESA_GL_VERSION_OVERRIDE="3.0COMPAT",
        MESA_SHADER_CACHE_DISABLE="true",
    )


def with_sums_hidden(path, disassembly, label):
    """The stage of a file, optimized and disassembled, with what is precise kept; disassembly: the stage as it is."""
    plain = run("spirv-dis", path)
    hidden = spirv_to_floats.hide_sums(plain)
    if hidden == plain:
        return disassembly
    other = path.with_suffix(".hidden")
    run("spirv-as", "--target-env", "opengl4.5", "-o", other, "-", input=hidden)
    return check_costs.optimized(other, label)


def rewrite(rows, folder):
    """Leaves the programs in folder: {number: (row, choice, the stage's disassembly)}; and what couldn't be rewritten."""
    texts, wrong = [], {}
    for row in rows:
        defines = check_costs.given_by(row[1]) + [(key, str(values[0])) for key, values in check_costs.OPEN.items()]
        whole = check_shaders.expand(ROOT / "shaders", row[0], defines)[0]
        texts += [(row[:2], choice, text) for choice, text in with_constants(whole, row[1])]
    programs = {}
    with tempfile.TemporaryDirectory(prefix="radiafit-r300-") as spirv:
        paths, said = check_shaders.compile_spirv([(text, "frag") for _, _, text in texts], spirv)
        for number, ((row, choice, _), path) in enumerate(zip(texts, paths)):
            if path is None:
                sys.exit(f"{row[0]} {row[1]}: {said}")
            try:
                disassembly = check_costs.optimized(path, " ".join(row))
                stage = spirv_to_floats.Stage(with_sums_hidden(path, disassembly, " ".join(row)), TEXTURE_SIZES)
            except (check_costs.CostError, spirv_to_floats.CannotRewrite) as error:
                wrong[row] = str(error)
                continue
            fragment, vertex = stage.glsl(GLSL)
            (folder / f"{number}.frag").write_text(fragment.replace("\n", f"\n// {' '.join(row)}; {choice}\n", 1))
            (folder / f"{number}.vert").write_text(vertex)
            programs[number] = (row, choice, disassembly)
    return programs, wrong


def compiled(said):
    """What the compiler's words about one program come to: slots, look-ups, levels, temporaries, and what it complains of."""
    found = dict.fromkeys(LIMITS)
    scheduled = re.findall(r"after 'pair scheduling'\n# Radeon Compiler Program\n(.*?)(?=^[A-Za-z])", said, re.S | re.M)
    if scheduled:
        instructions = re.findall(r"^ *\d+: *(.*)", scheduled[0], re.M)
        begun = [line.startswith("BEGIN_TEX") for line in instructions]
        look_ups = [line for line in instructions if re.match(r"(TEX|TXP|TXB|TXD|TXL|KIL)\b", line)]
        found["slots"] = len(instructions) - sum(begun) - len(look_ups)
        found["look_ups"] = len(look_ups)
        found["levels"] = sum(begun) + (0 if begun and begun[0] else 1)
    allocated = re.findall(r"after 'register allocation'\n# Radeon Compiler Program\n(.*?)(?=^[A-Za-z])", said, re.S | re.M)
    if allocated:
        used = [int(number) for number in re.findall(r"\btemp\[(\d+)\]", allocated[0])]
        found["temporaries"] = max(used, default=-1) + 1
    errors = re.findall(r"^(?:wrong: .*|.*Compiler Error:?.*(?:\n(?!r300|Using|message|===).+)*)", said, re.M)
    found["error"] = " ".join(dict.fromkeys(" ".join(errors).split("\n")))[:300]
    found["held"] = "Hardware program" in said and not errors
    return found


def results_of(programs, root, chip, folder):
    """By row what each of its programs comes to; and the driver's own words about itself."""
    result = subprocess.run([sys.executable, "-B", HERE / "compile_programs.py", folder], env=driver_environment(root, chip),
                            stderr=subprocess.PIPE, text=True, errors="replace")  # fmt: skip
    (folder / "said.txt").write_text(result.stderr)
    parts = re.split(r"^=== (\d+)\n", result.stderr, flags=re.M)
    about = re.findall(r"^(?:renderer|version): (.*)$", parts[0], re.M)
    if result.returncode or len(about) != 2:
        sys.exit(f"the driver ended with status {result.returncode}:\n{parts[-1][-2000:]}")
    found = {}
    for number, said in zip(map(int, parts[1::2]), parts[2::2]):
        row, choice, _ = programs[number]
        found.setdefault(row, []).append(dict(compiled(said), choice=choice))
    return found, ", ".join(about)


def why_not(found):
    over = [f"{name.replace('_', ' ')} {found[name]} > {most}" for name, most in LIMITS.items() if (found[name] or 0) > most]
    return "" if found["held"] else "; ".join(over) or found["error"] or "no code"


def size(one):
    return one["slots"] or 0, one["levels"] or 0


def table_of(rows, found, wrong):
    """A line a pass: the longest of its programs, and where some don't fit the longest that does."""
    table = []
    for name, variant, (operations, reads, _) in rows:
        line = dict(dict.fromkeys(COLUMNS), shader=name, variant=variant, operations=operations, reads=reads, programs=0, fitting=0)
        table.append(line)
        of_row = found.get((name, variant), [])
        if not of_row:
            line["why"] = wrong.get((name, variant), "not compiled")
            continue
        longest, fitting = max(of_row, key=size), [one for one in of_row if one["held"]]
        line.update({limit: longest[limit] for limit in LIMITS}, programs=len(of_row), fitting=len(fitting), longest=longest["choice"],
                    why=why_not(min(of_row, key=lambda one: one["held"])))  # fmt: skip
        if fitting:
            line["longest_fitting"] = max(one["slots"] for one in fitting)
    return table


def iterations(found, counts):
    """What the passes of an iteration come to, by problem and optimizer, of fig10_utilization's passes.csv."""
    by_label = {" ".join(row).strip(): programs for row, programs in found.items()}
    with counts.open() as file:
        drawn = [row for row in csv.DictReader(file) if row["passes"] == "r300"]
    for problem, optimizer in dict.fromkeys((row["problem"], row["optimizer"]) for row in drawn):
        total, over = dict.fromkeys(("slots", "look-ups", "operations", "reads", "fragments"), 0), 0
        for row in drawn:
            if (row["problem"], row["optimizer"]) != (problem, optimizer):
                continue
            if row["program"] not in by_label:
                sys.exit(f"{counts}: {row['program']}, which was not compiled")
            other_rules = {f"rule={rule}" for rule in GIVEN["rule"] if rule != RULES[optimizer]}
            own = max((one for one in by_label[row["program"]] if not other_rules & set(one["choice"].split())), key=size)
            total["slots"] += own["slots"] * int(row["fragments"])
            total["look-ups"] += own["look_ups"] * int(row["fragments"])
            over += 0 if own["held"] else own["slots"] * int(row["fragments"])
            for name in ("operations", "reads", "fragments"):
                total[name] += int(row[name])
        print(f"{problem}, {optimizer}: " + ", ".join(f"{number / 1e9:.4g} G {name}" for name, number in total.items())
              + f"; {100 * over / total['slots']:.3g} % of the slots in programs that don't fit")  # fmt: skip


def told(counts, programs):
    """Prints what differs() found; whether all is well."""
    names = {number: f"{' '.join(row)} {choice}".rstrip() for number, (row, choice, _) in programs.items()}
    wrong = [f"  other numbers: {names[number]}" for number, (different, _) in counts.items() if different]
    wrong += [f"  no number but 0 to compare: {names[number]}" for number, (_, results) in counts.items() if not results]
    few = [f"  {results} in place of {ENOUGH}: {names[number]}" for number, (_, results) in counts.items() if 0 < results < ENOUGH]
    well = sum(not different and results > 0 for different, results in counts.values())
    print(f"{well} of {len(counts)} rewritten programs write what the stage does; {len(counts) - len(few)} of them {ENOUGH} different "
          "results that are finite and not all 0")  # fmt: skip
    print(*wrong, *few, sep="\n", end="\n" if wrong or few else "")
    return bool(counts) and not wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("--counts", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--chip", default="R300_ND")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    rows = [row for row in passes() if options.only in " ".join(row[:2])]
    if not rows:
        refuse(f"--only {options.only}: no pass has this in its name or definitions")
    if options.keep and options.keep.exists() and not (options.keep.is_dir() and not any(options.keep.iterdir())):
        refuse(f"--keep {options.keep}: there is something already; name a new folder, or an empty one")
    if options.counts and not options.counts.is_file():
        refuse(f"--counts {options.counts}: no such file")
    if absent := [tool for tool in (*check_costs.TOOLS, "spirv-as") if not shutil.which(tool)]:
        refuse(f"{', '.join(absent)}: not installed; see scripts/install-packages.sh")
    root = fetch(options.folder.resolve())
    with tempfile.TemporaryDirectory(prefix="radiafit-r300-") as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        programs, wrong = rewrite(rows, folder)
        found, about = results_of(programs, root, options.chip, folder)
        counts = differs(programs, folder) if options.check else {}
    print(f"{about}, as {options.chip}: {len(programs)} programs of {len(rows)} passes")
    if not re.search(rf"\bMesa {re.escape(MEASURED.stem.partition('-')[2])}(?![\d.])", about):
        print(f"This is another Mesa than that of {MEASURED.name}: its programs may be others, and of other lengths")
    table = table_of(rows, found, wrong)
    for row in table:
        more = f", of at most {row['longest_fitting']} slots" if row["why"] and row["fitting"] else ""
        more += f" ({row['why']})" if row["why"] else ""
        print("{shader} {variant}: {slots} slots, {look_ups} look-ups, {levels} levels, {temporaries} temporaries; {operations} operations "
              "and {reads} reads declared; {fitting} of {programs} programs fit".format(**row) + more)
    print(f"{sum(row['fitting'] == row['programs'] > 0 for row in table)} of {len(table)} passes fit")
    if options.csv:
        with options.csv.open("w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(table)
    if options.counts:
        iterations(found, options.counts)
    if options.check:
        sys.exit(not told(counts, programs))


if __name__ == "__main__":
    main()
