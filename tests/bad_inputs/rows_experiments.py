"""Experiments: their command lines and configs, all checked before any work starts."""
import json

from bad_inputs.damage import append, folder, remove, replace, write

rows = []
NAMES = ("table1_datasets", "fig7_convergence", "fig8_time", "fig9_error", "fig10_utilization", "passes", "precision", "reflectance", "scaling",
         "solvers", "stopping", "streaming", "departures", "captures", "claims")  # fmt: skip


def run(name, more=""):
    return f"{name} --config experiments/{name}.toml --profile smoke {more}".strip()


def refuse(name, key, values, *words):
    """A row for each value of a key, given by --set."""
    for value in values:
        given = f"{key}={json.dumps(value) if not isinstance(value, str) else value}"
        rows.append((run(name, f"--set '{given}'"), None, 2, f"{name}: --set {given}: ", *words))


for name in NAMES:
    rows += [
        (run(name, "--set unheard_of=3"), None, 2, "--set unheard_of=3: unknown key 'unheard_of'"),
        (run(name), append(f"experiments/{name}.toml", "\nunheard_of = 1\n"), 2, f"experiments/{name}.toml:", "unknown key 'unheard_of'"),
    ]

maps = ("fig7_convergence", "fig8_time", "fig10_utilization", "passes", "precision", "solvers", "stopping", "streaming", "departures")
for name in maps:
    refuse(name, "surface_side", [65], "surface_side = ", "choose a whole number from 2 to 64")
    refuse(name, "lambda", [1e38], "lambda = ", "choose a number from 0 to 1e+06")
refuse("solvers", "surface_side", [1, -8], "surface_side = ", "choose a whole number from 2 to 64")
refuse("solvers", "view_side", [1.5, "eight", "[8]"], "'view_side' must be an integer of 32 bits")
refuse("solvers", "lambda", ["nan", "inf"], "'lambda' must be a finite number")
refuse("solvers", "lambda", [-1], "lambda = -1: choose a number from 0 to 1e+06")
for name in ("fig8_time", "passes", "precision", "scaling", "solvers", "stopping", "streaming", "departures"):
    refuse(name, "dataset", ["ornament"], "ornament has a lamp that moves", "choose star or bust")
refuse("departures", "reflectance", ["star"], "only the ornament has lights")
refuse("departures", "cg_iterations", [0], "cg_iterations = 0: choose a whole number from 1 to 1000000")
refuse("fig8_time", "dataset", ["moon"], 'unknown shape "moon"; there are star, bust and ornament')
refuse("fig10_utilization", "dataset", ["moon"], 'unknown shape "moon"')
for name in ("fig7_convergence", "fig9_error", "table1_datasets"):
    refuse(name, "datasets", [[]], "datasets = []: give one or more")
    refuse(name, "datasets", [["star", "moon"]], 'unknown shape "moon"; there are star, bust and ornament')
    refuse(name, "datasets", ["star"], "'datasets' must be a list of strings")
refuse("fig7_convergence", "datasets", [["star", "ornament"]], "ornament has a lamp that moves")
refuse("fig9_error", "datasets", [["ornament"]], "ornament has a lamp that moves")

refuse("fig9_error", "terms", [[1, 2, 99], [0], [-1, 1]], "terms = ", "choose a whole number from 1 to 16")
refuse("fig9_error", "terms", [[]], "terms = []: give one or more")
refuse("fig9_error", "terms", [[1, 2.5], "all", [[1]]], "'terms' must be a list of integers of 32 bits")
refuse("fig9_error", "high_side", [1, 65], "high_side = ", "choose a whole number from 2 to 64")
refuse("fig9_error", "low_side", [0], "low_side = 0: choose a whole number from 2 to 64")
for key in ("iterations", "modern_iterations", "opengl_iterations"):
    refuse("fig9_error", key, [-1, 1000001], f"{key} = ", "choose a whole number from 0 to 1000000")
for key in ("lambda_surface", "lambda_view", "other_lambdas"):
    refuse("fig9_error", key, [[-1], [0.1, 1e38]], f"{key} = ", "choose a number from 0 to 1e+06")
refuse("fig9_error", "refills", [[10, -1]], "refills = -1: choose a whole number from 0")
refuse("fig9_error", "seeds", [[-1]], "seeds = -1: choose a whole number from 0")
refuse("fig9_error", "validation", [1], "'validation' is 2 at least")
rows += [
    (run("fig9_error", "--set capture=nowhere"), None, 2, "nowhere: no such folder", "generate or import"),
    (run("fig9_error", "--set capture=flat"), None, 2, "flat: a grid of texels", "made for reflectance models"),
    (run("fig9_error", "--set capture=photos"), None, 2, "photos: not a packed dataset"),
]

refuse("fig7_convergence", "tolerance", [1, 0.5, -1], "tolerance = ", "a multiple of the best error")
refuse("fig7_convergence", "cap", [9, -1, 1000001], "cap = ", "choose a whole number from 10 to 1000000")
refuse("fig7_convergence", "problems", [0, 7], "problems = ", "choose a whole number from 1 to 6")
refuse("fig7_convergence", "seed", [-1], "seed = -1: choose a whole number from 0 to 2147483647")
refuse("fig7_convergence", "seed", [2**31, 1.5], "'seed' must be an integer of 32 bits")
for key in ("rival_iterations", "ends"):
    refuse("fig7_convergence", key, [0], f"{key} = ", "choose a whole number from 1 to 1000000")
refuse("fig7_convergence", "other_lambdas", [[1e-3, -1]], "other_lambdas = -1: choose a number from 0")
refuse("fig7_convergence", "other_lambdas", [[1e-4]], "'other_lambdas' has `lambda` among them")
refuse("fig7_convergence", "ends_cap", [100], "'ends_cap' needs at least `cap`")

for key in ("iterations", "software_iterations"):
    refuse("fig8_time", key, [1, 0], f"{key} = ", "from 2 to 1000000 (the first is not timed)")
refuse("fig8_time", "share_iterations", [[25, 0]], "share_iterations = 0: choose a whole number from 1 to 1000000")
refuse("fig8_time", "repetitions", [0], "repetitions = 0: choose a whole number from 1 to 1000000")
refuse("fig8_time", "software_seconds", [-1], "software_seconds = -1: choose a number from 0")
refuse("fig8_time", "source", ["disc"], "source 'disc' does not exist; choose one of disk, disk-cold, memory, device")
refuse("fig10_utilization", "source", ["disc"], "source 'disc' does not exist")
refuse("fig10_utilization", "passes", [[]], "passes = []: give one or more")
refuse("fig10_utilization", "passes", [["paper", "papr"]], "passes 'papr' does not exist; choose one of paper, r300, combined")
for key in ("images", "rounds", "cached_iterations"):
    refuse("passes", key, [0], f"{key} = 0: choose a whole number from 1")
refuse("fig10_utilization", "repetitions", [0], "repetitions = 0: choose a whole number from 1")
for name in ("fig10_utilization", "streaming"):
    refuse(name, "reflectance", ["star"], "star has no lamp that moves; choose ornament")
    refuse(name, "reflectance_side", [1, 65], "reflectance_side = ", "choose a whole number from 2 to 64")
    refuse(name, "reflectance_images", [-1], "reflectance_images = -1: choose a whole number from 0 to 1000000 (0 is all)")
refuse("streaming", "repetitions", [0, -5], "repetitions = ", "choose a whole number from 1")

refuse("precision", "passes", ["papr"], "passes 'papr' does not exist")
refuse("precision", "storage", [[], ["fp16"], ["fp32", "fp8"], "fp32"], "storage")
refuse("precision", "sums", [[], ["fp16", "fp32"], ["fp32", "fp8"]], "sums")
refuse("precision", "iterations", [0], "iterations = 0: choose a whole number from 1")
refuse("precision", "images", [-1], "images = -1: choose a whole number from 0 to 1000000 (0 is all)")

for key in ("read_noise", "shot_noise"):
    refuse("reflectance", key, [-0.1, 1.5], f"{key} = ", "choose a number from 0 to 1 (white is 1)")
for key in ("lm_iterations", "sd_iterations"):
    refuse("reflectance", key, [0], f"{key} = ", "choose a whole number from 1 to 1000000")
refuse("reflectance", "fragment_iterations", [-1], "fragment_iterations = -1: choose a whole number from 0")
refuse("reflectance", "within", [1, 0], "within = ", "a multiple of the best error")

refuse("scaling", "sides", [[], [8, 12, 99], [8, 1, 12]], "sides = ")
refuse("scaling", "sides", [[8, 12]], "'sides' a slope needs at least 3")
refuse("scaling", "texel_sides", [[8, 12]], "'texel_sides' a slope needs at least 3")
refuse("scaling", "images", [[5, 10, 0], [-1, 5, 10]], "images = ", "choose a whole number from 1")
refuse("scaling", "images", [[5, 10]], "'images' a slope needs at least 3")
for key in ("rounds", "cpu_iterations", "texel_images", "distribution_images"):
    refuse("scaling", key, [0], f"{key} = ", "choose a whole number from 1 to 1000000")
refuse("scaling", "side", [1, 65], "side = ", "choose a whole number from 2 to 64")

for key in ("vertices", "cap", "repetitions"):
    refuse("solvers", key, [0], f"{key} = ", "choose a whole number from 1 to 1000000")
refuse("solvers", "tolerance", [1], "tolerance = 1: choose a number from ")
refuse("solvers", "seconds", [-1], "seconds = -1: choose a number from 0")
refuse("solvers", "seed", [-7], "seed = -7: choose a whole number from 0")

refuse("stopping", "levels", [[]], "levels = []: give one or more")
refuse("stopping", "levels", [[1, 0], [-1]], "levels = ", "choose a number from 1e-06 to 1e+06")
refuse("stopping", "levels", [["one"], 5], "'levels' must be a list of finite numbers")
refuse("stopping", "cap", [10], "'cap' needs at least `cg_iterations`")
refuse("table1_datasets", "terms", [0, 17], "terms = ", "choose a whole number from 1 to 16")
refuse("table1_datasets", "surface_side", [1, 65], "surface_side = ", "choose a whole number from 2 to 64")
refuse("captures", "every", [1, 0], "every = ", "choose a whole number from 2 to 1000")
refuse("captures", "lit_fits", [["gloss: --model gloss"]], "model 'gloss' does not exist")
refuse("captures", "light_field_fits", [["K = 17: --model lfm --terms 17"]], "terms = ", "choose a whole number from 1 to 16")
refuse("captures", "few_fits", [["--model ptm"], [": --model ptm"]], "write a name, a colon, and options")
refuse("captures", "few_fits", [["ptm: --clip-above 0.9"]], "names no --model")
refuse("captures", "few_fits", [["ptm: --model"]], "--model has no value")
refuse("captures", "few_fits", [["ptm: --model ptm 3"]], "'3' is no option of radiafit fit")
refuse("claims", "results", ['""'], "results = '': name the folder that the runs lie in")

# What is wrong in the file itself is said with its line, in any profile.
toml = "experiments/fig9_error.toml"
rows += [
    (run("fig9_error"), replace(toml, r"terms = \[1, 2, 3\]", "terms = [1, 99]"), 2, f"{toml}:", "terms = 99: choose"),
    (run("fig9_error"), replace(toml, r"opengl_iterations = 40", "opengl_iterations = -40"), 2, f"{toml}:", "opengl_iterations = -40: choose"),
    (run("fig9_error"), replace(toml, r"validation = 8", "validation = 8 9"), 2, f"{toml}:"),
    (run("fig9_error"), replace(toml, r"validation = 8", 'validation = "ten"'), 2, f"{toml}:", "'validation' must be an integer of 32 bits, not a string"),
    (run("fig9_error"), write(toml, ""), 2, f"{toml}: no profile 'smoke'; add a table [profile.smoke]"),
    (run("fig9_error"), write(toml, "\x00\xff"), 2, f"{toml}:"),
    (run("fig9_error"), write(toml, "[profile.smoke]\n" + "a=[" * 5000), 2, f"{toml}:"),
    (run("fig9_error"), write(toml, "profile = 3\n"), 2, f"{toml}:1: 'profile' must hold tables"),
    (run("fig9_error"), remove(toml), 2, f"{toml}: no such configuration file"),
    (run("fig9_error"), folder(toml), 2, f"{toml}: no such configuration file"),
    (run("fig9_error", "--set terms"), None, 2, "--set terms: write it as key=value"),
    (run("fig9_error", "--set =3"), None, 2, "--set =3: write it as key=value"),
    (run("fig9_error", "--threads -1"), None, 2, "threads = -1: choose a whole number from 0 to 1024"),
    (run("fig9_error", "--threads many"), None, 2, "threads = 'many': choose a whole number from 0 to 1024"),
    ("fig9_error", None, 2, "fig9_error: experiments/fig9_error.toml: ", "lies in a checkout"),
    ("fig9_error --config ''", None, 2, "config = '': give a name"),
    ("fig9_error --config experiments/none.toml", None, 2, "experiments/none.toml: no such configuration file"),
    ("fig9_error --config experiments/fig9_error.toml --profile huge", None, 2, f"{toml}: no profile 'huge'; choose one of: "),
    (run("fig9_error", "--sett terms=3"), None, 2, "option '--sett' does not exist", "nearest is --set"),
    (run("fig9_error"), append(toml, "\nbroken = \n"), 2, f"{toml}:"),
    (run("claims", "--set results=elsewhere"), None, 2, "say by --output where the verdicts go"),
    (run("fig9_error", "--run nowhere"), None, 2, "nowhere/run.json: no such "),
    (run("fig9_error", "extra"), None, 2, "'extra' is one argument too many"),
]
