#!/usr/bin/env python3
"""Every shader stage compiles under glslang (glslc), to SPIR-V for OpenGL (which demands locations: of uniforms any); those of
published pages, "#version 300 es", as WebGL 2 takes them, for which there is no SPIR-V.

#include "..." lines are expanded as src/core/gl/shader_text.cpp does: relative to shaders/, each file once, #line kept, definitions
after the #version line, and where the name of a file is a definition's, that in its place. A stage is compiled

  - as it stands;
  - with each macro that it tests by #ifdef, #if NAME == VALUE or #if NAME > VALUE given one at a time; or, in its place,
  - with every combination on each line of its first ten, "-" being "not defined":
        // variants: TERMS=1,3 STORAGE=0,1,2 ALONG=-,1
    MODEL=* stands for every texel-local model of a lamp's and an eye's direction: those texts in shaders/model that define
    BASIS_COUNT and sample_terms(), themselves or in a part that they include. STEP=* and UPDATE=* stand for every step and update of an optimizer, with what belongs
    to it; LOSS=* for none and every one in loss.glsl.

Texts shared with C++ (shaders/model, shaders/optimize) that no stage reaches are compiled inside an empty stage, with
LOBE_COUNT 1 and 2 where they ask for it, and any other .glsl file that no stage reaches is an error: it would be untested.
Which samples a pass takes must not depend on which program it is in: positions are invariant, and what texels find their
pixels by is precise, with sums written out, since a driver may order those of dot() as it likes (PRECISE). What compilers of some
drivers get wrong is not written (AVOIDED).
Usage: check_shaders.py [ROOT]. Exit status 77 (skipped) without glslc or glslangValidator."""
import concurrent.futures
import itertools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FOR_PAGES = "#version 300 es"  # how those of published pages begin
STAGES = {".vert": "vert", ".frag": "frag", ".comp": "comp"}
INCLUDE = re.compile(r'\s*#include\b(?:\s*"([^"]+)")?')
CONDITION = re.compile(r"^\s*#\s*(?:el)?if(n?def)?\b(.*)$", re.M)
COMPARISON = re.compile(r"\b([A-Z][A-Z0-9_]*)\s*(==|>|>=)\s*(\d+)")
DEFAULT = re.compile(r"^\s*#\s*ifndef\s+(\w+)\s*\n\s*#\s*define\s+\1\b", re.M)
TOOLS = ("glslc", "glslangValidator")
# By file, the names of what decides which samples are taken.
PRECISE = {
    "distribute/camera_row.glsl": ("sum",), "distribute/tiles.glsl": ("b", "first"), "distribute/cover_tile.glsl": ("at",),
    "distribute/item.vert": ("clip",), "distribute/take.glsl": ("q", "at"), "combine/take_item.glsl": ("q", "at"),
    "compute/taken.glsl": ("q", "at"), "distribute/camera.glsl": (), "combine/cameras.glsl": (),
}  # fmt: skip


# What compilers of some drivers drop, or cannot do: what to write instead.
AVOIDED = {
    r"\bis(nan|inf)\(": "some compilers take it for false; look at the bits",
    r"\bbool(\[\d*\]| \w+\[)": "an array of truth values, of which Mesa's zink makes no Vulkan; write a bvec",
}


class ShaderError(Exception):
    pass


def expand(shaders, name, defines=(), files=None):
    """The text that the driver gets, and the files in it in the order of #line's second number. The first is a stage,
    unless files is given."""
    stage = files is None
    files = [] if stage else files
    index = len(files)
    files.append(name)
    path = shaders / name
    if not path.is_file():
        raise ShaderError(f"shaders/{name}: no such file")
    out = [] if stage else [f"#line 1 {index}"]
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        include = INCLUDE.match(line)
        if number == 1 and stage:
            out.append(line)
            out += [f"#define {key} {value}" for key, value in defines]
            out.append(f"#line 2 {index}")
        elif include:
            if not include[1]:
                raise ShaderError(f"shaders/{name}:{number}: #include needs a file in quotes")
            file = pathlib.PurePosixPath(include[1])
            file = str(file.with_name(dict(defines).get(file.stem, file.stem) + file.suffix))
            if file not in files:
                out.append(expand(shaders, file, defines, files)[0])
            out.append(f"#line {number + 1} {index}")
        else:
            out.append(line)
    return "\n".join(out), files


def texel_models(shaders):
    texts = {path.stem: path.read_text(encoding="utf-8") for path in (shaders / "model").glob("*.glsl")}
    parts = {name: re.findall(r'#include "model/(\w+)\.glsl"', text) for name, text in texts.items()}
    parts_of_others = {part for of_one in parts.values() for part in of_one}
    whole = {name: "".join([text, *(texts[part] for part in parts[name])]) for name, text in texts.items()}
    return sorted(name for name, text in whole.items()
                  if name not in parts_of_others and "#define BASIS_COUNT" in text and " sample_terms(" in text)


def optimizer_texts(shaders, axis):
    """The definitions of each step, or update, that a text in shaders/optimize holds; src/core/optim/methods.h lists them."""
    found = []
    for path in sorted((shaders / "optimize").glob("*.glsl")):
        state = "ProblemState" if axis == "STEP" else "Elements"
        for name in re.findall(rf"^SHARED_FN void (\w+)\(INOUT\({state}\)", path.read_text(encoding="utf-8"), re.M):
            found.append([("TEXT", path.stem), (axis, name)])
    listed = (shaders.parent / "src" / "core" / "optim" / "methods.h")
    shapes = re.findall(r"X\((\w+), (\w+)((?:, \d+)*)\)", listed.read_text(encoding="utf-8")) if listed.is_file() else []
    for defines in found:
        numbers = [row[2].split(", ")[1:] for row in shapes if [row[0], row[1]] == [value for _, value in defines]]
        if not numbers:
            raise ShaderError(f"shaders/optimize/{defines[0][1]}.glsl: src/core/optim/methods.h doesn't list {defines[1][1]}")
        defines += zip(("VECTORS", "WRITTEN", "NUMBERS", "PRODUCTS"), numbers[0])
    return found


def losses(shaders):
    names = re.findall(r"^SHARED_FN element (\w+)_weight\(", (shaders / "model/loss.glsl").read_text(encoding="utf-8"), re.M)
    return [[]] + [[("LOSS_VALUE_OF", name + "_value"), ("LOSS_WEIGHT_OF", name + "_weight"), ("LOSS_SCALE", "0.1")]
                   for name in names]


def declared_variants(shaders, path):
    variants = []
    for line in path.read_text(encoding="utf-8").splitlines()[:10]:
        if not line.startswith("// variants:"):
            continue
        axes = []
        for name, values in (item.split("=", 1) for item in line.split(":", 1)[1].split()):
            if values == "*" and name in ("STEP", "UPDATE"):
                axes.append(optimizer_texts(shaders, name))
            elif (name, values) == ("LOSS", "*"):
                axes.append(losses(shaders))
            else:
                values = texel_models(shaders) if (name, values) == ("MODEL", "*") else values.split(",")
                axes.append([[(name, value)] if value != "-" else [] for value in values])
        variants += [sum(choice, []) for choice in itertools.product(*axes)]
    return variants or None


def found_variants(text):
    """One definition at a time, as the conditions in the text suggest."""
    defaults = set(DEFAULT.findall(text))
    found = {}
    for kind, rest in CONDITION.findall(text):
        if kind:
            name = rest.split()[0]
            if kind == "def" and name not in defaults and not name.startswith("GL_"):
                found.setdefault(name, set()).add("")
        for name, relation, value in COMPARISON.findall(rest):
            found.setdefault(name, set()).add(str(int(value) + (relation == ">")))
    # A macro compared by value somewhere is never given without one.
    return [[]] + [[(name, value)] for name in sorted(found)
                   for value in sorted(found[name] - {""} or found[name])]


def messages_of(text, stage, files, label):
    """What glslangValidator says of one text that doesn't compile."""
    # -G100: SPIR-V for OpenGL. --stdin must come before -S.
    target = [] if text.startswith(FOR_PAGES) else ["-G100", "--aml", "--amb", "-o", "/dev/null"]
    result = subprocess.run(["glslangValidator", *target, "--stdin", "-S", stage], input=text, capture_output=True, text=True)
    if result.returncode == 0:
        return []
    messages = []
    for line in (result.stdout + result.stderr).splitlines():
        place = re.match(r"ERROR: (\d+):(\d+): (.*)", line.replace("stdin", "0"))
        if place and int(place[1]) < len(files):
            messages.append(f"shaders/{files[int(place[1])]}:{place[2]}: {place[3]}   [{label}]")
    return messages or [f"{label}: {(result.stdout + result.stderr).strip()}"]


def compile_spirv(texts, folder):
    """Many texts in one process, (text, stage) each, to SPIR-V for OpenGL: the paths of the outputs, None where a text
    doesn't compile, and what the compiler says."""
    folder = pathlib.Path(folder)
    for number, (text, stage) in enumerate(texts):
        (folder / f"{number}.{stage}").write_text(text, encoding="utf-8")
    names = [f"{number}.{stage}" for number, (_, stage) in enumerate(texts)]
    result = subprocess.run(["glslc", "--target-env=opengl4.5", "-fauto-map-locations", "-fauto-bind-uniforms", "-c", *names],
                            cwd=folder, capture_output=True, text=True)
    outputs = [folder / (name + ".spv") for name in names]
    return [output if output.is_file() else None for output in outputs], result.stdout + result.stderr


def compile_texts(texts):
    """The errors of (text, stage, files, label) each. Compilers take long to start, so each gets many texts; one that
    fails is compiled once more, alone, for messages that name its files."""
    errors = []
    with tempfile.TemporaryDirectory(prefix="radiafit-shaders-") as folder:
        if texts[0][0].startswith(FOR_PAGES):
            for number, (text, stage, _, _) in enumerate(texts):
                (pathlib.Path(folder) / f"{number}.{stage}").write_text(text, encoding="utf-8")
            result = subprocess.run(["glslangValidator", *(path.name for path in pathlib.Path(folder).iterdir())], cwd=folder,
                                    capture_output=True, text=True)
            failed, said = texts if result.returncode else [], result.stdout + result.stderr
        else:
            outputs, said = compile_spirv([text[:2] for text in texts], folder)
            failed = [text for text, output in zip(texts, outputs) if not output]
    for text in failed:
        errors += messages_of(*text)
    return errors or ([said] if failed else [])


def label_of(name, defines):
    return " ".join([name] + [f"{key}={value}" if value else key for key, value in defines])


def stage_texts(shaders, name):
    """What is wrong without compiling, and what there is to compile: (text, stage, files, label)."""
    errors, texts = [], []
    path = shaders / name
    try:
        if not path.read_text(encoding="utf-8").startswith("#version "):
            raise ShaderError(f"shaders/{name}:1: a stage begins with #version")
        variants = declared_variants(shaders, path) or found_variants(expand(shaders, name)[0])
        for defines in variants:
            text, files = expand(shaders, name, defines)
            texts.append((text, STAGES[path.suffix], files, label_of(name, defines)))
    except ShaderError as error:
        errors.append(str(error))
    return errors, texts


def shared_texts(shaders, name):
    """What there is to compile of a text that C++ shares, as above: inside an empty stage, behind the dialect's prelude and, for the optimizer, its state."""
    before = ["model/prelude.glsl"] if name != "model/prelude.glsl" and not name.startswith("model/prelude_") else []
    if name.startswith("optimize/") and name != "optimize/problem_state.glsl":
        before.append("optimize/problem_state.glsl")
    parts = []
    try:
        files = []
        for include in before + [name]:
            if include not in files:
                parts.append(expand(shaders, include, (), files)[0])
    except ShaderError as error:
        return [str(error)], []
    texts = []
    for lobes in ("1", "2") if "LOBE_COUNT" in parts[-1] else ("",):
        define = [f"#define LOBE_COUNT {lobes}"] if lobes else []
        text = "\n".join(["#version 450 core"] + define + parts + ["void main() {}"]) + "\n"
        texts.append((text, "frag", files, " ".join([name, "in an empty stage"] + define)))
    return [], texts


def unstable(shaders, names):
    """Positions that may differ from program to program, sums whose order is the compiler's, and what compilers get wrong."""
    errors = []
    for name in names:
        text = (shaders / name).read_text(encoding="utf-8")
        if name.endswith(".vert") and not text.startswith(FOR_PAGES):
            try:
                whole = expand(shaders, name)[0]
            except ShaderError:
                continue  # told elsewhere
            if "invariant gl_Position;" not in whole:
                errors.append(f"shaders/{name}: gl_Position must be invariant")
        text = re.sub("//.*", "", text)
        for pattern, instead in AVOIDED.items():
            if (found := re.search(pattern, text)) and FOR_PAGES not in text:
                errors.append(f"shaders/{name}: {found[0]}: {instead}")
        for variable in PRECISE.get(name, ()):
            if not re.search(rf"\bprecise \w+ {variable} =", text):
                errors.append(f"shaders/{name}: {variable} must be precise")
        if name in PRECISE and re.search(r"\bdot\(", text):
            errors.append(f"shaders/{name}: write the sum out, in place of dot()")
    return errors


def check(root):
    shaders = pathlib.Path(root) / "shaders"
    names = sorted(path.relative_to(shaders).as_posix() for path in shaders.rglob("*") if path.is_file())
    errors, texts = unstable(shaders, names), []

    def add(found):
        errors.extend(found[0])
        texts.extend(found[1])

    for name in names:
        suffix = pathlib.PurePosixPath(name).suffix
        if suffix in STAGES:
            add(stage_texts(shaders, name))
        elif suffix != ".glsl":
            errors.append(f"shaders/{name}: the name ends in none of .vert .frag .comp .glsl")
    reached = {file for _, _, files, _ in texts for file in files}
    for name in names:
        if not name.endswith(".glsl") or name in reached:
            continue
        if name.startswith(("model/", "optimize/")):
            add(shared_texts(shaders, name))
        else:
            errors.append(f"shaders/{name}: no stage includes it, so nothing compiles it")
    cores = len(os.sched_getaffinity(0))
    of_pages = [text for text in texts if text[0].startswith(FOR_PAGES)]
    others = [text for text in texts if not text[0].startswith(FOR_PAGES)]
    parts = [part for part in [of_pages, *(others[core::cores] for core in range(cores))] if part]
    with concurrent.futures.ThreadPoolExecutor(cores) as threads:  # each waits for its compiler
        for found in threads.map(compile_texts, parts):
            errors += found
    return errors, len(texts)


def main():
    for tool in TOOLS:
        if not shutil.which(tool):
            print(f"skipped: {tool} is absent (scripts/install-packages.sh installs it)")
            return 77
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    errors, count = check(root)
    print("\n".join(errors) if errors else f"{count} shader texts compile")
    return 1 if errors or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
