#!/usr/bin/env python3
"""No include, and no link list, breaks the rings or the layers within them. RINGS: core, fits, harness, tools; a ring sees
those within it. Layers: base < geometry < model < dataset < samples < optim < cpu | fragment | reference; image and gl on base,
fragment on gl, and compute on fragment; synthetic on dataset; fit on dataset and image, capture on these and lamps, lamps on geometry, stereo on capture, eval on
fit; report and command_line on base; bench on what reads no foreign file. Experiments are of the harness.

Also: that src/CMakeLists.txt and the map in docs/architecture.md name the same layers, that no class is defined twice
where one place sees both, which folder may include which foreign library, that heavy headers stay out of our headers, and that
no message of a library names options and commands as the command line has them, which mean nothing to its caller.
Usage: check_layers.py [ROOT]"""
import pathlib
import re
import sys

RINGS = {
    "core": ["base", "image", "geometry", "model", "batch", "dataset", "synthetic", "samples", "optim", "cpu", "gl", "fragment", "compute",
             "fit", "eval"],
    "fits": ["ownmodel", "reference", "basis", "viewbasis", "lightbasis", "sg", "reachable", "fitting"],
    "harness": ["report", "command_line", "bench"],
    "tools": ["lamps", "capture", "stereo", "rti", "exchange", "publish", "cli", "python"],
}
RING_OF = {layer: ring for ring, layers in RINGS.items() for layer in layers}
CHAIN = ["base", "geometry", "model", "dataset", "samples", "optim"]


def up_to(layer):
    return set(CHAIN[: CHAIN.index(layer) + 1])


def rings(*names):
    return {layer for name in names for layer in RINGS[name]}


# What each layer may include, besides itself.
ALLOWED = {layer: set(CHAIN[:i]) for i, layer in enumerate(CHAIN)}
ALLOWED.update(
    cpu=up_to("optim"),
    image={"base"},
    batch={"base", "model"},
    image_web={"base"},  # src/core/image/web, a target of its own
    gl={"base"},
    fragment=up_to("optim") | {"gl"},
    compute=up_to("optim") | {"gl", "fragment"},
    synthetic=up_to("dataset"),
    fit=up_to("dataset") | {"image"},
    eval=up_to("dataset") | {"image", "fit"},
    ownmodel=up_to("optim") | {"cpu", "gl"},
    reference=up_to("optim"),
    basis=up_to("samples") | {"gl"},
    viewbasis=up_to("samples") | {"image", "gl", "fit", "eval", "basis"},
    lightbasis=up_to("samples") | {"image", "gl", "fit", "eval", "basis", "viewbasis"},
    sg=up_to("optim") | {"image", "cpu", "gl", "fit", "eval", "basis", "viewbasis"},
    reachable=up_to("samples") | {"image", "gl", "fit", "eval", "basis", "viewbasis"},
    fitting=rings("core") | {"ownmodel", "reference", "basis", "viewbasis", "lightbasis", "sg"},
    report={"base"},
    command_line={"base"},
    bench=up_to("optim") | {"cpu", "gl", "fragment", "compute", "synthetic", "report", "command_line"},
    lamps=up_to("geometry"),
    capture=up_to("dataset") | {"image", "lamps"},
    stereo=up_to("dataset") | {"image", "lamps", "capture"},
    rti=rings("core", "fits") | {"lamps", "capture"},
    exchange=rings("core", "fits") | {"image_web"},
    publish=rings("core", "fits") | {"image_web"},
    cli=rings("core", "fits", "harness", "tools") | {"image_web"},
    python=rings("core", "fits"),
)
EXPERIMENTS = rings("core", "fits", "harness")

# Texts under shaders/ that C++ includes too, and the first layer that may.
SHARED_TEXTS = {"model": "model", "optimize": "optim"}

# Foreign headers and the folders of src/ that may include them.
LIBRARIES = [
    (r"OpenImageIO/", {"image"}),
    (r"libheif/", {"image"}),
    (r"(OpenEXR/|Imf|Imath|Iex)", {"image"}),
    (r"png\.h", {"image"}),
    (r"lcms2\.h", {"capture"}),
    (r"(GL|EGL|GLES\d?|KHR)/", {"gl"}),
    (r"(ceres|glog|gsl)/", {"reference"}),
    (r"nlopt\.h", {"reference"}),
    (r"toml\+\+/", {"base"}),
    (r"CLI/", {"command_line"}),
    (r"(webp/|jpeglib)", {"image"}),
    (r"pybind11/", {"python"}),
]
HEAVY = re.compile(r"(OpenImageIO/|OpenEXR/|Imf|ceres/|toml\+\+/|nlohmann/)")
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')

PROGRAMS = {"fitting", "command_line", "cli", "bench", "report",  # whose messages nobody reads but at the command line
            "python"}  # whose documentation leads to the program's

# What only a user of the program knows; base/wording.h says it to them, and to others in other words.
TYPED = re.compile(r"(?<![\w-])--[a-z][\w-]*|\bradiafit (?:capture|compare|devices|export|fit|generate|import|info|judge|options|plan|publish|render|tune)\b")
# No messages: these functions put down, in a dataset, the command that makes it again.
PROVENANCE = {"src/tools/capture/import.cpp": "provenance", "src/tools/capture/import_lights.cpp": "provenance",
              "src/core/synthetic/synthetic.cpp": "synthetic_source"}
TOKEN = re.compile(r"""(?P<skip>\s+|//[^\n]*|/\*.*?\*/)
    | (?:u8|[uUL])?R"(?P<mark>[^()\s]*)\((?P<raw>.*?)\)(?P=mark)"
    | (?:u8|[uUL])?"(?P<text>(?:\\.|[^"\\\n])*)"
    | (?P<other>'(?:\\.|[^'\\\n])+' | \d[\w.']* | \w+ | .)""", re.X | re.S)


def includes(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found[1], found[2]


def sources(folder):
    return sorted(path for path in folder.rglob("*") if path.suffix in (".h", ".cpp"))


def check_include(layer, path, own, foreign):
    """What is wrong with one include line of a file of src/LAYER, or None."""
    if own is not None:
        if own.endswith(".glsl"):
            first = SHARED_TEXTS.get(own.split("/")[0])
            if first is None:
                return "is no text shared with C++"
            target = first
        elif "/" not in own:
            return "names no layer: write folder/file.h"
        else:
            target = own.split("/")[0]
        if target not in ALLOWED:
            return f"'{target}' is no layer"
        if target != layer and target not in ALLOWED[layer]:
            return f"{layer} may not include {target}"
        return None
    for pattern, folders in LIBRARIES:
        if re.match(pattern, foreign) and layer not in folders:
            return f"only {', '.join(sorted(folders))} may include it"
    if path.suffix == ".h" and HEAVY.match(foreign):
        return "too heavy for a header: include it in a .cpp"
    return None


def literals(text):
    """(place, content, whether it is the first argument of at_command_line) of each string literal; adjacent ones are one."""
    place, parts, before = 0, [], ["", ""]
    for token in TOKEN.finditer(text):
        if token["skip"]:
            continue
        if token["other"] is None:
            place = place if parts else token.start()
            parts.append(token["raw"] if token["text"] is None else token["text"])
            continue
        if parts:
            yield place, "".join(parts), before == ["at_command_line", "("]
        parts, before = [], [before[1], token["other"]]


def check_words(root, path):
    text, name = path.read_text(encoding="utf-8"), path.relative_to(root).as_posix()
    exempt = range(0)
    if name in PROVENANCE:
        function = re.search(rf"^\S[^\n;]*\b{PROVENANCE[name]}\([^;{{]*{{$.*?^}}", text, re.M | re.S)
        if function is None:
            return [f"{name}: has no function {PROVENANCE[name]}; correct PROVENANCE in tests/check_layers.py"]
        exempt = range(*function.span())
    errors = []
    for place, content, chosen in literals(text):
        typed = TYPED.search(content)
        if typed and not chosen and place not in exempt:
            errors.append(f"{name}:{text.count(chr(10), 0, place) + 1}: '{typed[0]}' means nothing to a caller of the library: "
                          "say it by option_name() or at_command_line() (base/wording.h)")
    return errors


def layer_folders(root):
    """(layer, its folder) of src/RING/LAYER."""
    for ring in sorted(path for path in (root / "src").iterdir() if path.is_dir()):
        for folder in sorted(path for path in ring.iterdir() if path.is_dir()):
            yield folder.name, folder


def check_sources(root):
    errors, count = [], 0
    for layer, folder in layer_folders(root):
        if folder.parent.name != RING_OF.get(layer):
            errors.append(f"{folder.relative_to(root)}: not a layer of this ring; see RINGS in tests/check_layers.py")
            continue
        for path in sources(folder):
            for number, own, foreign in includes(path):
                wrong = check_include(layer, path, own, foreign)
                if wrong:
                    errors.append(f"{path.relative_to(root)}:{number}: {own or foreign}: {wrong}")
                count += own is not None
            if layer not in PROGRAMS:
                errors += check_words(root, path)
    for path in sources(root / "experiments") if (root / "experiments").is_dir() else []:
        for number, own, foreign in includes(path):
            where = f"{path.relative_to(root)}:{number}: {own or foreign}"
            if own and own.split("/")[0] in ALLOWED and own.split("/")[0] not in EXPERIMENTS:
                errors.append(f"{where}: experiments may not include {own.split('/')[0]}")
            # They bring in none of the libraries that have a place.
            for pattern, folders in LIBRARIES:
                if foreign and re.match(pattern, foreign):
                    errors.append(f"{where}: only {', '.join(sorted(folders))} may include it")
    return errors, count


def classes(path):
    """(namespace, class) of each class, struct and enum that a header defines in a namespace, which is never indented."""
    spaces = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if opened := re.match(r"namespace ([\w:]*) *\{$", line):
            spaces.append(opened[1])
        elif re.match(r"\}(  // namespace.*)?$", line) and spaces:
            spaces.pop()
        elif found := re.match(r"(?:template <.*> ?)?(?:class|struct|enum class|enum) (?:alignas\(\w+\) )?(\w+)\b[^;<]*(?:\{|$)", line):
            yield "::".join(spaces), found[1]
        if re.match(r"(?:template <.*> ?)?(?:class|struct|enum).*\{$", line):
            spaces.append("{")
        elif line.startswith("};") and spaces and spaces[-1] == "{":
            spaces.pop()


def check_classes(root):
    """A class of one name twice in one namespace breaks a program without a word; of two rings, one hides the other."""
    seen, errors = {}, []
    for path in (path for _, folder in layer_folders(root) for path in sources(folder) if path.suffix == ".h"):
        for space, name in classes(path):
            if "{" in space:
                continue
            ringless = re.sub(r"^radiafit::(fits|harness|tools)\b", "radiafit", space)
            first = seen.setdefault((ringless, name), path)
            if first != path:
                errors.append(f"{path.relative_to(root)}: defines {space}::{name}, as {first.relative_to(root)} does; rename one")
    return errors


def check_map(root):
    """That src/CMakeLists.txt and docs/architecture.md have the layers of RINGS, each in its ring."""
    errors = []
    build = root / "src/CMakeLists.txt"
    if build.exists():
        text = build.read_text(encoding="utf-8")
        for ring, layers in RINGS.items():
            found = re.search(rf"^set\({ring} ([^)]*)\)", text, re.M)
            if found is None or set(found[1].split()) != set(layers) - {"python"}:
                errors.append(f"src/CMakeLists.txt: set({ring} ...) is not RINGS of tests/check_layers.py")
    page = root / "docs/architecture.md"
    if page.exists():
        rows = re.findall(r"^\| (\w+) \| `(\w+)` \|", page.read_text(encoding="utf-8"), re.M)
        for ring, layers in RINGS.items():
            told = {layer for where, layer in rows if where == ring}
            for layer in sorted(told ^ set(layers)):
                errors.append(f"docs/architecture.md: the map {'has' if layer in told else 'lacks'} {layer} in {ring}")
    return errors


def check_links(root):
    """radiafit_layer(NAME LINKS radiafit_x ...): with all that those link in turn, no more than NAME may include; and
    every layer that NAME's files include is among them."""
    direct, errors, at = {}, [], {}
    for path in sorted((root / "src").glob("*/*/CMakeLists.txt")):
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        for name, rest in re.findall(r"radiafit_layer\(\s*(\w+)([^)]*)\)", text):
            links = re.search(r"\bLINKS\b(.*?)(\bEXTERNAL\b|$)", rest, re.S)
            direct[name] = set(re.findall(r"\bradiafit_(\w+)", links[1])) if links else set()
            at[name] = path.relative_to(root)

    def closure(name):
        result = set()
        for link in direct.get(name, ()):
            result |= {link} | closure(link)
        return result

    for name in direct:
        linked = closure(name)
        for extra in sorted(linked - ALLOWED.get(name, set())):
            errors.append(f"{at[name]}: {name} may not link {extra}")
        included = {own.split("/")[0] for path in sources((root / at[name]).parent) for _, own, _ in includes(path)
                    if own and not own.endswith(".glsl")}
        for missing in sorted((included & ALLOWED.get(name, set())) - linked - {name}):
            errors.append(f"{at[name]}: {name} includes {missing} but doesn't link it")
    return errors, len(direct)


def check(root):
    root = pathlib.Path(root)
    source_errors, count = check_sources(root)
    link_errors, targets = check_links(root)
    return source_errors + link_errors + check_classes(root) + check_map(root), count, targets


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    errors, count, targets = check(root)
    print("\n".join(errors) if errors else f"{count} includes and {targets} link lists keep to the layers")
    return 1 if errors or count == 0 or targets == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
