"""Fits and records: fit.json, its maps, what judge, render and info make of them, and what two-step keeps."""
from bad_inputs.damage import GONE, append, copied, cut, field, folder, patch, remove, replace, signed_field, write

rows = []
fit, flat, light = "fit/fit.json", "flatfit/fit.json", "lightfit/fit.json"
again = "restore it or fit again"

# Every field that is read: gone, or of another type.
for place in ("format", "version", "model", "solver", "engine", "space", "lfm", "lfm.terms", "lfm.surface_side", "lfm.view_side",
              "lfm.lookup", "lfm.lambda_surface", "problems", "problems.status",
              "problems.status.stationary", "dataset", "dataset.path", "dataset.digest", "options"):  # fmt: skip
    rows.append(("info fit", field(fit, place, GONE), 2, f"{fit}: ", again))
for place in ("model", "reflectance", "reflectance.parameters", "reflectance.mode", "reflectance.clip_above", "dataset.path"):
    rows.append(("info flatfit", field(flat, place, GONE), 2, f"{flat}: ", again))
for place, value in (("lfm.terms", "two"), ("lfm.terms", None), ("lfm.terms", 0), ("lfm.terms", 17), ("lfm.surface_side", 1),
                     ("lfm.surface_side", 65), ("lfm.view_side", 0), ("lfm.view_side", 1000), ("lfm.lookup", "cubic"), ("lfm.mode", "old"),
                     ("lfm.lambda_surface", -1), ("lfm.lambda_view", "small"), ("lfm.mu", -1), ("lfm.lower", 16), ("space", "srgb"),
                     ("format", "radiafit-dataset"), ("version", 0), ("version", 99), ("version", "1"),
                     ("dataset.encoding", "u8"), ("dataset.path", 5), ("dataset.views", "all"), ("problems.status.stationary", "many")):  # fmt: skip
    rows.append(("info fit", field(fit, place, value), 2, f"{fit}: ", again))
for place, value in (("model", "phong"), ("reflectance.parameters[0]", "rho"), ("reflectance.mode", "old"),
                     ("reflectance.clip_above", 2), ("reflectance.shadow_below", -1), ("reflectance.mu", -1)):  # fmt: skip
    rows.append(("info flatfit", field(flat, place, value), 2, f"{flat}: ", again))
for place in ("lightbasis.lamps", "lightbasis.length", "lightbasis.smoothing", "lightbasis.noise", "lightbasis.rank"):
    rows.append(("info lightfit", field(light, place, GONE), 2, f"{light}: ", again))
for value in (0, -1, "long", None, 0.5):  # the last without its half vectors
    rows.append(("info lightfit", field(light, "lightbasis.half_length", value), 2, f"{light}: ", again))
rows.append(("judge lightfit", None, 0, "PSNR"))
for size in (0, 0.3, 0.7, -2):
    rows.append(("info fit", cut(fit, size), 2, f"{fit}: ", again))
rows += [
    ("judge fit", cut(fit, 0.5), 2, f"{fit}: ", again),
    ("render fit -o new", cut(fit, 0.5), 2, f"{fit}: ", again),
    ("info fit", write(fit, "[]"), 2, f"{fit}: ", again),
    ("info fit", write(fit, "null"), 2, f"{fit}: ", again),
    ("info fit", write(fit, "[" * 100000), 2, f"{fit}: "),
    ("info fit", append(fit, "x"), 2, f"{fit}: ", again),
    ("info fit", replace(fit, '"mu": 1', '"mu": 1e999'), 2, f"{fit}: ", again),
    ("judge fit", field(fit, "options.validation", "all"), 2, "fit.json's options.validation", "fit again"),
    ("judge fit", field(fit, "options.validation", -1), 2, "fit.json's options.validation", "fit again"),
    ("judge fit", field(fit, "options.validation", 1.5), 2, "fit.json's options.validation", "fit again"),
    ("judge fit", remove(fit), 2, f"{fit}: no such file", "give a folder that radiafit fit wrote"),
    ("render fit -o new", remove(fit), 2, f"{fit}: no such file", "give a folder that radiafit fit wrote"),
    ("info fit", remove(fit), 2, "fit: neither a dataset nor a fit"),
    ("judge tiny", None, 2, "tiny/fit.json: no such file", "give a folder that radiafit fit wrote"),
    ("render tiny -o new", None, 2, "tiny/fit.json: no such file"),
    ("judge nowhere", None, 2, "nowhere: no such folder", "radiafit fit writes one"),
    ("render nowhere -o new", None, 2, "nowhere: no such folder", "radiafit fit writes one"),
    ("judge fit/fit.json", None, 2, "fit/fit.json: no such folder", "radiafit fit writes one"),
    ("info nowhere", None, 2, "nowhere: no such folder", "radiafit generate or import makes a dataset"),
]

# The dataset of a fit
rows += [
    ("judge fit", field(fit, "dataset.path", "../gone"), 2, "gone: the dataset of this fit (tiny) is no longer there", "move it back"),
    ("render fit -o new", field(fit, "dataset.path", "../gone"), 2, "gone: the dataset of this fit (tiny) is no longer there"),
    ("judge flatfit", field(flat, "dataset.path", "../gone"), 2, "gone: the dataset of this fit (flat) is no longer there"),
    ("judge fit --dataset nowhere", None, 2, "nowhere: the dataset of this fit (tiny) is no longer there"),
    ("judge fit --dataset flat", None, 2, "flat: differs from the dataset that was fitted", "name the right folder"),
    ("judge fit --json --dataset flat", None, 2, "flat: differs from the dataset that was fitted"),
    ("render fit --dataset flat -o new", None, 2, "flat: differs from the dataset that was fitted"),
    ("info fit --dataset flat", None, 2, "flat: differs from the dataset that was fitted"),
    ("judge flatfit --dataset tiny", None, 2, "tiny: differs from the dataset that was fitted"),
    ("judge fit --dataset fit", None, 2, "fit: not a packed dataset"),
    ("judge fit", field("tiny/dataset.json", "views[1].camera.fx", 21), 2, "tiny: differs from the dataset that was fitted"),
    ("judge fit", field("tiny/dataset.json", "views[1].held_out", True), 2, "tiny: differs from the dataset that was fitted"),
    ("judge fit", field(fit, "dataset.digest", "0"), 2, "tiny: differs from the dataset that was fitted"),
    ("judge fit --dataset moved", copied("tiny", "moved"), 0, "PSNR"),
    ("judge flatfit", None, 0, "PSNR"),
    ("judge wholefit", None, 2, "whole", "train"),
    ("judge wholefit --split train", None, 0, "PSNR"),
]

# Maps
for name in ("problems", "view_term0", "surface_term0_corner2"):
    path = f"fit/{name}.exr"
    for size in (0, 4, 0.3, 0.6, -1):
        rows.append(("info fit", cut(path, size), 2, f"{path}: ", "write it again"))
    rows.append(("judge fit", remove(path), 2, f"{path}: no such file; restore it or write it again"))
    rows.append(("info fit", folder(path), 2, f"{path}: no such file; restore it or write it again"))
    rows.append(("info fit", write(path, "no picture"), 2, f"{path}: ", "write it again"))
for name in ("problems", "rho_d", "shape"):
    path = f"flatfit/{name}.exr"
    for size in (0, 0.5, -1):
        rows.append(("info flatfit", cut(path, size), 2, f"{path}: ", "write it again"))
    rows.append(("judge flatfit", remove(path), 2, f"{path}: no such file; restore it or write it again"))
rows += [
    ("render fit -o new", cut("fit/view_term0.exr", -100), 2, "fit/view_term0.exr: ", "write it again"),
    ("info fit", copied("fit/problems.exr", "fit/view_term0.exr"), 2, "fit/view_term0.exr: ", "where 16 x 16 belong"),
    ("info fit", copied("fit/view_term0.exr", "fit/surface_term0_corner0.exr"), 2, "fit/surface_term0_corner0.exr: "),
    ("info fit", copied("fit/view_term0.exr", "fit/problems.exr"), 2, "fit/problems.exr: "),
    ("info flatfit", copied("fit/view_term0.exr", "flatfit/rho_d.exr"), 2, "flatfit/rho_d.exr: "),
    ("info fit", copied("lit/exr/0.exr", "fit/view_term0.exr"), 2, "fit/view_term0.exr: "),
    ("info fit", field(fit, "problems.status.stationary", 7), 2, "fit/problems.exr: its statuses disagree with those counted in fit.json"),
    ("info fit", field(fit, "lfm.terms", 2), 2, "_term1", "no such file"),
    ("info fit", field(fit, "lfm.surface_side", 9), 2, "fit/surface_term0_corner"),
    ("info fit", field(fit, "lfm.view_side", 9), 2, "fit/view_term0.exr: "),
    ("info fit", field(fit, "dataset.vertices", 5), 2, "fit/mesh.ply: 4 vertices and 2 triangles, but fit.json says 5 and 2"),
    ("info fit", cut("fit/mesh.ply", 0.7), 2, "fit/mesh.ply: "),
    ("info fit", remove("fit/mesh.ply"), 2, "fit/mesh.ply: the file is missing or cannot be read"),
    ("info fit", remove("fit/trace.csv"), 0, "fit of tiny"),
]

# Records
records, texels = "records/records.json", "texrecords/records.json"
keep = "fit tiny --solver two-step --iterations 1 --records records -o new"
keep_texels = "fit flat --model lafortune --solver two-step --records texrecords -o new"
for size in (0, 0.5, -2):
    rows.append((keep, cut(records, size), 2, f"{records}: "))
    rows.append((keep_texels, cut(texels, size), 2, f"{texels}: "))
for size in (0, 0.5, -1):
    rows.append((keep, cut("records/index.bin", size), 2, "records/index.bin: "))
    rows.append((keep, cut("records/records.bin", size), 2, "records/records.bin: "))
    rows.append((keep_texels, cut("texrecords/index.bin", size), 2, "texrecords/index.bin: "))
    rows.append((keep_texels, cut("texrecords/records.bin", size), 2, "texrecords/records.bin: "))
for name in ("records.json", "index.bin", "records.bin"):
    rows.append((keep, remove(f"records/{name}"), 2, f"records/{name}: "))
    rows.append((keep_texels, remove(f"texrecords/{name}"), 2, f"texrecords/{name}: "))
for place, value in (("format", "radiafit-fit"), ("version", 1), ("key", "another"), ("kind", "full"), ("bits", 16), ("bytes", 1),
                     ("views", []), ("checksum", 1), ("index_checksum", 1)):  # fmt: skip
    rows.append((keep, field(records, place, value), 2, "records"))
rows += [
    (keep, patch("records/records.bin", 20, b"\xaa\xbb"), 2, "records/records.bin: "),
    (keep, patch("records/index.bin", 8, b"\xaa"), 2, "records/index.bin: "),
    (keep_texels, patch("texrecords/records.bin", 20, b"\xaa\xbb"), 2, "texrecords/records.bin: "),
    (keep_texels, patch("texrecords/index.bin", 8, b"\xaa"), 2, "texrecords/index.bin: "),
    (keep.replace("--records", "--record full --records"), None, 2, "records"),
    (keep.replace("--records", "--space linear --records"), None, 2, "records"),
    (keep.replace("--records", "--surface-side 9 --records"), None, 2, "records"),
    (keep_texels.replace("--model lafortune", "--model lambert"), None, 0, "see new"),
    ("fit flat --model lafortune --solver two-step --records records -o new", None, 2, "records"),
    ("fit tiny --solver two-step --records texrecords -o new", None, 2, "texrecords"),
    ("fit tiny --solver two-step --records tiny -o new", None, 2, "tiny"),
    ("fit tiny --solver two-step --records tiny/mesh.ply -o new", None, 2, "tiny/mesh.ply"),
    ("fit tiny --solver two-step --records new/records -o new", None, 2, "new/records: the records' folder and the fit's lie one inside the other"),
    ("fit tiny --solver two-step --records new -o new", None, 2, "new: the records' folder and the fit's lie one inside the other"),
    ("fit tiny --solver two-step --records . -o new", None, 2, "the records' folder and the fit's lie one inside the other"),
    (keep, field("tiny/dataset.json", "views[1].camera.fx", 21), 2, "records"),
    (keep, None, 0, "see new"),
    (keep_texels, None, 0, "see new"),
]

# Whole numbers are whole, in fit.json as in records whose checksum fits all the same.
for place in ("lfm.terms", "lfm.surface_side", "lfm.view_side"):
    for value in (True, 2.9, 2**32 + 2):
        rows.append(("info fit", field(fit, place, value), 2, f"{fit}: ", again))
for value in (2**32 + 2, True, 2**64, [3]):
    rows.append(("judge fit", field(fit, "options.validation", value), 2, "fit.json's options.validation"))
for place, value in (("lfm.lambda_surface", 1e38), ("lfm.upper", 1e300), ("dataset.vertices", 4.5), ("dataset.vertices", -4),
                     ("problems.status.stationary", -1), ("problems.status.stationary", 1.5)):  # fmt: skip
    rows.append(("info fit", field(fit, place, value), 2, f"{fit}: ", again))
for place, values in (("bits", ["8", 7, 2**40]), ("scale", ["1", [], -1, 0, 1e300]), ("bytes", ["1", -1, 2**62]),
                      ("views", [5, ["a"], [-1], [99, 98], [1e30], [2**32]]), ("kind", [5, "thin"]), ("index_checksum", ["1"])):  # fmt: skip
    for value in [*values, GONE]:
        rows.append((keep, signed_field(records, place, value), 2, "records/"))
for place, values in (("texels", ["4", -1, 2**62, 5, 1e30, 2**70]), ("kind", [5, "compact"]), ("index_checksum", ["1"])):
    for value in [*values, GONE]:
        rows.append((keep_texels, signed_field(texels, place, value), 2, "texrecords/"))
window = "\x0f\x00\x00\x00\x0f\x00\x00\x00"  # 16 x 16 pixels
rows.append(("info fit", replace("fit/view_term0.exr", window, "\x80\x3e\x00\x00\x80\x3e\x00\x00"), 2, "fit/view_term0.exr: "))

# What a fit that was stopped left
part, journal = "stopped.parts/part-a.bin", "stopped.parts/whole.journal"
beside = write("stopped.parts/letter.txt", "")
resume = "fit tiny --terms 1 --iterations 1 --resume -o stopped"
other = "stopped.parts: holds parts of another fit: "
rows += [
    ("fit tiny --terms 2 --iterations 1 --resume -o stopped", beside, 2, other, "--terms is 1 there, 2 here",
     "give the command that was stopped, or leave out --resume to begin anew"),
    ("fit tiny --terms 1 --iterations 7 --lambda-view 1 --resume -o stopped", beside, 2, other, "--iterations is 1 there, 7 here", "--lambda-view is "),
    ("fit whole --terms 1 --iterations 1 --resume -o stopped", beside, 2, other, "it is of another dataset"),
    ("fit tiny --terms 2 --iterations 1 --shard 1/1 -o stopped.parts", None, 2, other, "choose another folder"),
    (resume, replace(part, r'program\\":\\"[^\\]', r'program\\":\\"!'), 2, other, "the program is '!", "here"),
    (resume, replace(part, r'"key"', r'"yek"'), 2, "part-a.bin: damaged; delete it"),
    (resume, replace(journal, r'"program":"[^"]', r'"program":"!'), 2, other, "the program is '!", "here"),
    ("fit tiny --checkpoint -1 -o new", None, 2, "checkpoint = -1", "0 is never"),
    ("fit tiny --checkpoint soon -o new", None, 2, "checkpoint"),
]  # fmt: skip
for damage in (cut(part, 0), cut(part, 7), cut(part, 200), patch(part, 0, b"\xff" * 8), patch(part, 8, b"[[[["), patch(part, 8, b"[" * 500)):
    rows.append((resume, damage, 2, "part-a.bin: damaged; delete it"))
for damage in (write(journal, ""), write(journal, "x" * 99), cut(journal, 0.5), patch(journal, 3, b"X"), patch(journal, 0, b"[" * 300)):
    rows.append((resume, damage, 2, other, "leave out --resume"))
