"""Commands of the program and of an experiment, their inputs, and places to run them in."""
import contextlib
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from cli_fixture import write_capture, write_png, write_points
from judge import Contents, Verdict, outputs, reference

CHECKOUT = pathlib.Path(__file__).resolve().parent.parent.parent
INPUTS = "../../inputs"
PATIENCE_S = 300  # no run takes that long, whatever else the machine does


@dataclass(frozen=True)
class Command:
    name: str
    variants: tuple  # arguments of three runs whose outputs differ: the new one, an older one, another
    program: str = "radiafit"
    steps: bool = False  # several outputs, one after another: the first may be whole where the last fails

    def states(self):
        """Whether there is an older output that it begins over."""
        return (False, True)

    def arguments(self, variant):
        """With the option that replaces an older output; experiments have names of their own."""
        return (*self.variants[variant], *(("--replace",) if self.program == "radiafit" else ()))

    def forced(self):
        """The option that begins a run though the disk will not suffice."""
        looks = self.variants[0][0] in ("generate", "import", "fit") or self.variants[0][:2] == ("capture", "depths")
        return ("--force",) if looks else ()


def command(name, arguments, option, values, **more):
    """Variants by the values of one option."""
    return Command(name, tuple((*arguments.split(), option, str(value)) for value in values), **more)


def fit(name, options, option="--iterations", values=(4, 2, 3), dataset="star", **more):
    return command(f"fit {name}", f"fit {INPUTS}/{dataset} -o out {options}", option, values, **more)


def reflectance(name, options, option="--iterations", values=(4, 2, 3), **more):
    return fit(f"lafortune {name}", f"--model lafortune {options}", option, values, dataset="ornament", **more)


def render(name, options, option, values, fitted="lfm"):
    return command(f"render {name}", f"render {INPUTS}/{fitted} -o out {options}", option, values)


def renders_of_fits(name, options):
    """The same picture of three fits."""
    return Command(f"render {name}", tuple(("render", f"{INPUTS}/texels{i}", "-o", "out", *options) for i in (0, 1, 2)))


def of_three_fits(name, arguments, output, of):
    return Command(name, tuple((*arguments.split(), f"{INPUTS}/{of}{i}", "-o", output) for i in (0, 1, 2)))


def experiment(name, option, values):
    return command(name, f"--config experiments/{name}.toml --profile smoke", "--set", [f"{option}={v}" for v in values],
                   program=name, steps=True)


MODEL = f"--model {INPUTS}/capture/sparse"
CAPTURE = f"{MODEL} --images {INPUTS}/capture/images --mesh {INPUTS}/capture/mesh.ply"
LAMPS = f"--images {INPUTS}/lamps/images --lights {INPUTS}/lamps/lights.txt"
HOLDOUTS = ("every:8", "every:5", "none")

COMMANDS = (
    command("generate star", "generate star -o out", "--seed", (1, 2, 3)),
    command("generate ornament", "generate ornament -o out", "--seed", (1, 2, 3)),
    command("import colmap", f"import colmap {CAPTURE} --gains estimate -o out", "--holdout", HOLDOUTS),
    command("import lights", f"import lights {LAMPS} -o out", "--holdout", HOLDOUTS),
    fit("stream cpu", ""),
    fit("stream fragment", "--engine fragment"),
    fit("two-step", "--solver two-step"),
    fit("two-step with records", "--solver two-step --records records --sort-memory 20K", steps=True),
    fit("pca", "--solver pca", "--terms", (1, 2, 3)),
    fit("ceres", "--solver ceres"),
    fit("als", "--solver als"),
    fit("varpro", "--solver varpro"),
    fit("mean", "--solver mean", "--surface-side", (8, 5, 6)),
    reflectance("stream cpu", ""),
    reflectance("stream fragment", "--engine fragment"),
    reflectance("two-step", "--solver two-step"),
    reflectance("two-step with records", "--solver two-step --records records --sort-memory 1M", steps=True),
    reflectance("ceres", "--solver ceres"),
    render("view", "", "--view", (0, 3, 5)),
    render("turntable", "", "--turntable", (4, 3, 2)),
    render("relit", "", "--light", ("0,0,1", "0.3,0.4,0.8", "0.6,0,0.8"), fitted="texels0"),
    renders_of_fits("problems", ("--problems",)),
    of_three_fits("export gltf", "export gltf", "out.glb", "texels"),
    of_three_fits("export maps", "export maps", "out", "texels"),
    of_three_fits("export rti", "export rti", "out", "relief"),
    of_three_fits("publish", "publish", "out", "texels"),
    of_three_fits("publish one file", "publish --single-file", "out.html", "texels"),
    command("capture depths", f"capture depths {MODEL} --images {INPUTS}/capture/images -o out", "--seed", (1, 2, 3)),
    command("capture cut-mesh", f"capture cut-mesh {INPUTS}/capture/mesh.ply {MODEL} --depths {INPUTS}/depths -o out.ply",
            "--region", (1.2, 0.8, 0.9)),
    Command("capture preview", tuple(
        (*f"capture preview --model {INPUTS}/{of}/sparse --images {INPUTS}/{of}/images -o out.png".split(), *mesh)
        for of, mesh in (("capture", ("--mesh", f"{INPUTS}/capture/mesh.ply")), ("capture", ()), ("other-capture", ())))),
    command("solve", f"solve {INPUTS}/decays/decays.csv --model {INPUTS}/decays/decay.glsl -o out --start "
            "first=500,first_life=1,second=200,second_life=5,background=5", "--iterations", (50, 2, 3)),
    command("capture masks", f"capture masks {INPUTS}/capture/mesh.ply {MODEL} -o out", "--inset", (2, 0, 5)),
    experiment("table1_datasets", "terms", (1, 2, 3)),
    experiment("fig7_convergence", "cap", (40, 50, 60)),
)


class Place:
    """A folder to run a command in, with things in it that are not the program's to touch."""

    def __init__(self, scene, folder):
        self.scene, self.folder = scene, folder
        self.temporary = scene.root / "tmp" / folder.name
        self.before = None

    def fill(self, command, older):
        """As it is before the command: `older`: with the output of an earlier run."""
        self.scene.need(command)
        for folder in (self.folder, self.temporary):
            folder.mkdir(parents=True, exist_ok=True)
            for entry in folder.iterdir():
                shutil.rmtree(entry) if entry.is_dir() and not entry.is_symlink() else entry.unlink()
        (self.folder / "neighbour.txt").write_text("nobody's\n")
        for name in (".hidden-neighbour", ".tmp-neighbour", ".radiafit-tmp-neighbour"):
            (self.folder / name).write_text("nobody's either\n")
        if command.program != "radiafit":
            self.make_checkout()
        if older:
            shutil.copytree(self.scene.older(command), self.folder, dirs_exist_ok=True)
        self.before = Contents(self.folder)

    def make_checkout(self):
        """What an experiment finds beside itself."""
        for name, ending in (("experiments", ".toml"), ("paper_figs", ".gp")):
            (self.folder / name).mkdir()
            for file in (CHECKOUT / name).glob("*" + ending):
                shutil.copy(file, self.folder / name)

    def restore(self, command, older):
        """Like fill(), but what killed runs left stays."""
        aside = self.scene.root / "aside" / self.folder.name
        leftovers = sorted(outputs(self.folder)[1] - self.before.hidden)
        for name in leftovers:
            (aside / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name).rename(aside / name)
        self.fill(command, older)
        for name in leftovers:
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (aside / name).rename(self.folder / name)
        shutil.rmtree(aside, ignore_errors=True)

    def start(self, command, variant=0, wrapper=(), more=(), asked=True, **options):
        """The run's standard error goes to a pipe, unless told otherwise. It has a process group of its own. `asked`: to replace
        an older output."""
        arguments = command.arguments(variant) if asked else command.variants[variant]
        return subprocess.Popen(
            [*wrapper, str(self.scene.programs[command.program]), *arguments, *more],
            cwd=self.folder, env={**self.scene.environment, "TMPDIR": str(self.temporary)}, stdin=subprocess.DEVNULL,
            start_new_session=True,
            **{"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True, "errors": "replace", **options})

    def run(self, command, variant=0, **options):
        """Exit status and standard error."""
        return self.finish(self.start(command, variant, **options))

    @staticmethod
    def finish(process):
        """Exit status and standard error, once all that the run started has ended, too."""
        try:
            _, said = process.communicate(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            _, said = process.communicate()
            said = f"{said or ''}\nhung for {PATIENCE_S} s\n"
        with contextlib.suppress(ProcessLookupError):
            while True:  # a killed run's gnuplot goes on for a moment
                os.killpg(process.pid, 0)
                time.sleep(0.005)
        return process.returncode, said or ""

    def verdict(self, command, variants=(0,)):
        return Verdict(self.folder, self.before, [self.scene.reference(command, v) for v in variants])

    def leftovers_elsewhere(self):
        return [f"leftover {path.name} in the folder for temporary files" for path in self.temporary.iterdir()]

    def run_clean(self, command):
        """An undisturbed run: all new, and no leftovers of those before. Violations."""
        status, said = self.run(command)
        if status != 0:
            return [f"an undisturbed run: {complaint(status, said) or said.strip()}"]
        return [f"after an undisturbed run: {text}"
                for text in self.verdict(command).after_success() + self.leftovers_elsewhere()]


def complaint(status, said):
    """What is wrong with how a run that failed ended: it says one line, and no signal ends it. '' if nothing."""
    if status not in (1, 2):
        return f"exit status {status}: {said.strip()[-200:]}"
    errors = [line for line in said.splitlines() if line.startswith(("radiafit: ", "fig7_convergence: ", "table1_datasets: "))]
    return "" if len(errors) == 1 and said.endswith(errors[0] + "\n") else f"not one line at the end: {said.strip()[-200:]}"


class Scene:
    """Inputs, references and places below one temporary folder; safe to use from several threads."""

    def __init__(self, build):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-faults-"))
        self.programs = {"radiafit": build / "bin/radiafit"}
        self.programs.update({c.program: build / "experiments" / c.program for c in COMMANDS if c.program != "radiafit"})
        self.environment = {**os.environ, "LC_ALL": "C", "MESA_SHADER_CACHE_DIR": str(self.root / "shader-cache")}
        self.environment.pop("DISPLAY", None)
        self.environment["XDG_CACHE_HOME"] = str(self.root / "cache")  # of compiled models
        self.lock, self.locks, self.references, self.count = threading.Lock(), {}, {}, 0
        for name in ("shader-cache", "inputs"):
            (self.root / name).mkdir()

    def radiafit(self, *arguments):
        subprocess.run([str(self.programs["radiafit"]), *map(str, arguments)], cwd=self.root / "inputs", env=self.environment,
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=True)

    def make(self, name):
        """An input, when it is first asked for; others that it is made from first."""
        with self.lock_of(name):
            if not (self.root / "inputs" / name).exists():
                self.INPUTS[name.removeprefix("other-")](self, name)

    def need(self, command):
        for arguments in command.variants:
            for name in re.findall(f"{INPUTS}/([^/ ]+)", " ".join(arguments)):
                self.make(name)

    def make_star(self, name):
        self.radiafit("generate", "star", "--seed", 2 if name.startswith("other-") else 1, "-o", name)

    def make_ornament(self, name):
        self.radiafit("generate", "ornament", "-o", name)

    def make_capture(self, name):
        star = name.replace("capture", "star")
        self.make(star)
        write_capture(self.root / "inputs" / star, self.root / "inputs" / name)
        write_points(self.root / "inputs" / star, self.root / "inputs" / name / "sparse")

    def make_depths(self, name):
        self.make("capture")
        self.radiafit("capture", "depths", "--model", "capture/sparse", "--images", "capture/images", "-o", name)

    def make_decays(self, name):
        shutil.copytree(CHECKOUT / "examples/solve", self.root / "inputs" / name)
        self.radiafit("solve", f"{name}/decays.csv", "--model", f"{name}/decay.glsl", "--iterations", 1, "-o", f"solved-{name}",
                      "--start", "first=500,first_life=1,second=200,second_life=5,background=5")  # compiles the model

    def make_lamps(self, name):
        write_lamps(self.root / "inputs" / name, seed=name)

    def make_light_field(self, name):
        self.make("star")
        self.radiafit("fit", "star", "--iterations", 3 if name.startswith("other-") else 2, "-o", name)

    def make_records(self, name):
        self.make("star")
        self.radiafit("fit", "star", "--solver", "two-step", "--iterations", 1, "--records", name, "-o", f"fit-of-{name}")

    def make_texels(self, name):
        self.make("ornament")
        self.radiafit("fit", "ornament", "--model", "lafortune", "--iterations", 2 + int(name[-1]), "-o", name)

    def make_relief(self, name):
        self.make("lamps")
        self.radiafit("import", "lights", "--images", "lamps/images", "--lights", "lamps/lights.txt", "--normals", "flat", "-o", f"packed-{name}")
        self.radiafit("fit", f"packed-{name}", "--model", "lambert", "--clip-above", 0.5 + 0.1 * int(name[-1]), "-o", name)

    INPUTS = {"star": make_star, "ornament": make_ornament, "capture": make_capture, "depths": make_depths, "decays": make_decays, "lamps": make_lamps,
              "lfm": make_light_field, "records": make_records, "texels0": make_texels, "texels1": make_texels,
              "texels2": make_texels, "relief0": make_relief, "relief1": make_relief, "relief2": make_relief}

    def place(self):
        with self.lock:
            self.count += 1
            return Place(self, self.root / "places" / str(self.count))

    def lock_of(self, key):
        with self.lock:
            return self.locks.setdefault(key, threading.Lock())

    def reference(self, command, variant=0):
        """What this run leaves where nothing disturbs it."""
        return self.undisturbed(command, variant)[0]

    def older(self, command):
        """A folder with what the older variant left."""
        return self.undisturbed(command, 1)[1]

    def undisturbed(self, command, variant):
        key = (command.name, variant)
        with self.lock_of(key):
            if key not in self.references:
                place = Place(self, self.root / "undisturbed" / f"{command.name.replace(' ', '-')}-{variant}")
                place.fill(command, older=False)
                status, said = place.run(command, variant)
                if status != 0:
                    raise RuntimeError(f"{command.name}: {' '.join(command.variants[variant])}: status {status}: {said}")
                self.references[key] = (reference(place.folder, place.before), place.folder)
            return self.references[key]


def write_lamps(folder, seed):
    """Images of a bumpy plane under ten lamps, for import lights."""
    rng = random.Random(seed)
    (folder / "images").mkdir(parents=True)
    width, height, lines = 40, 30, []
    for i in range(10):
        x, y = rng.uniform(-0.7, 0.7), rng.uniform(-0.7, 0.7)
        lines.append(f"{x} {y} 1")
        write_png(folder / "images" / f"{i:02}.png", width, height, bytes(rng.randrange(20, 250) for _ in range(3 * width * height)))
    (folder / "lights.txt").write_text("\n".join(lines) + "\n")
