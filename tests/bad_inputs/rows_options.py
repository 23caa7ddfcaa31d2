"""Options: values out of range, no numbers, unknown names, what means nothing to the solver, and whole command lines."""
import shlex

rows = []


def refuse(command, values, *words):
    """A row for each value: {} stands for it in the command and in the words."""
    for value in shlex.split(values):
        rows.append((command.replace("{}", shlex.quote(value)), None, 2, *(w.replace("{}", value) for w in words)))


def accept(command, *words):
    rows.append((command, None, 0, *words))


# A number that is none, and one that is one too far on either side; then what is just within.
rest = "two nan 1e1 0x2 '1 2' 99999999999999999999"
refuse("fit tiny --terms {} -o new", rest, "terms = '{}': choose a whole number from 1 to 16")
whole = "2.5 ''"
for option, below, above, least, most in (
    ("--terms", "0", "17", "1", "3"), ("--surface-side", "1", "65", "2", "9"),
    ("--view-side", "1", "65", "2", "9"), ("--iterations", "-1", "1000001", "0", "2"),
    ("--validation", "-1", "1000001", "0", "2"), ("--device", "-2", "1024", "-1", "0"),
    ("--seed", "-1 -0", "18446744073709551616", "0", "18446744073709551615"), ("--threads", "-1", "1025", "0", "1024"),
):  # fmt: skip
    plain = option[2:]
    refuse(f"fit tiny {option} {{}} -o new", whole, f"{plain} = '{{}}': choose a whole number from ")
    refuse(f"fit tiny {option} {{}} -o new", f"{below} {above}", f"{plain} = ", "choose a whole number from ")
    accept(f"plan tiny {option} {least}")
refuse("fit tiny --validation {} -o new", "1", "validation = 1: choose a whole number from 0", "1 would leave nothing to fit")

# tune holds what is given, and then has to find a model that takes it.
refuse("tune tiny --model {}", "lafortune", "no model that suits", "takes all of --model {}")
refuse("tune tiny --terms 2 {} 3", "--lobes", "no model that suits", "takes all of --terms 2 {} 3")

numbers = "two ''"
refuse("fit tiny --mu {} -o new", "0,5 1e1x 1e", "mu = '{}': choose a number from 0 to 1e+06")
for option, below, above, least, most in (
    ("--lambda-surface", "-1e-9 nan", "1.1e6 1e38", "0", "1e6"), ("--lambda-view", "-1", "1e7 inf", "0", "1e6"),
    ("--mu", "-1 nan", "1e7", "0", "1e6"), ("--stop-residual", "-1", "inf", "0", "1"),
    ("--stop-change", "-1", "inf", "0", "1"),
):  # fmt: skip
    plain = option[2:]
    refuse(f"fit tiny {option} {{}} -o new", numbers, f"{plain} = '{{}}': choose a number from 0 to 1e+06")
    refuse(f"fit tiny {option} {{}} -o new", f"{below} {above}", f"{plain} = ", "choose a number from 0 to 1e+06")
    accept(f"plan tiny {option} {least}")
    rows.append((f"fit tiny --iterations 3 {option} {most} -o new", None, 0, " 0 not finite"))
for solver in ("tinysolver", "ceres-varpro"):
    for command in ("fit tiny --solver {} -o new", "plan tiny --solver {}"):
        rows.append((command.format(solver), None, 2, f"solver {solver} does not fit light field maps; choose one of stream, "))
    rows.append((f"fit flat --model lafortune --solver {solver} -o new", None, 0, " 0 not finite"))
    rows.append((f"fit flat --model lafortune --solver {solver} --optimizer sd -o new", None, 2, "--optimizer means nothing to model "))
refuse("fit tiny --optimizer lbfgs --history {} -o new", "0 9 x ''", "history = ", "choose a whole number from 1 to 8")
refuse("fit tiny --optimizer adam --learning-rate {} -o new", "0 11 nan x ''", "learning-rate = ", "choose a number from 1e-06 to 10")
for optimizer in ("lbfgs --history 1", "lbfgs --history 8", "adam --learning-rate 1e-6", "adam --learning-rate 10"):
    rows.append((f"fit tiny --iterations 3 --optimizer {optimizer} -o new", None, 0, " 0 not finite"))
for options in ("cg --history 4", "sd --learning-rate 1", "adam --history 4", "lbfgs --learning-rate 1", "adam --stop-change 1"):
    rows.append((f"fit tiny --optimizer {options} -o new", None, 2, f"{options.split()[1]} means nothing to optimizer ", "leave it out"))
refuse("fit flat --model lafortune --prior {} -o new", "neighbours ''", "prior '{}'", "none, surface")
for fit in ("flat --model lafortune --optimizer cg", "flat --model lafortune --loss huber", "flat --model lambert --solver ceres", "tiny"):
    rows.append((f"fit {fit} --prior surface -o new", None, 2, "--prior means nothing to "))
accept("fit flat --model lafortune --prior surface --shard 1/2 -o new")
accept("fit tiny --model viewbasis --engine compute -o new")
rows.append(("fit tiny --model viewbasis --engine fragment -o new", None, 2, "--engine fragment does not fit view bases", "choose --engine cpu or --engine compute"))
for option in ("--context osmesa", "--device 1", "--distributor gl"):
    rows.append((f"fit tiny --model viewbasis {option} -o new", None, 2, f"{option.split()[0]} means nothing to ", "leave it out"))
rows.append(("fit tiny --model viewbasis --covariance -o new", None, 2, "--covariance: view bases have no error bars", "choose lfm"))
for option in ("--clip-above", "--shadow-below"):
    refuse(f"fit flat --model lafortune {option} {{}} -o new", "-0.1 1.01 nan ''", f"{option[2:]} = ", "choose a number from 0 to 1 (0 is off)")
refuse("fit tiny --solver pca --refills {} -o new", "-1 1000001 x ''", "refills = ", "choose a whole number from 0 to 1000000")
refuse("fit tiny --solver two-step --sort-memory {} -o new", "0 64X M '' 1e30 nan 64MB", "sort-memory '{}': give bytes, such as 64M or 2G")
accept("fit tiny --solver two-step --sort-memory 1 --iterations 1 -o new")
refuse("fit tiny --memory {} -o new", "0 64X M '' 1e30 nan 64MB", "memory '{}': give bytes, such as 64M or 2G")
refuse("fit tiny --memory {} -o new", "1 64M", "are too little to put the fit together", "give --memory more")
refuse("fit tiny --shard {} -o new", "0/2 3/2 -1/2 1 1/ /2 1/2x 1/0 x", "shard '{}': give which and of how many, such as 2/7")
refuse("merge {} -o new", "tiny nowhere", "{}")
refuse("plan tiny --engine {}", "foo", "engine '{}' does not exist; choose one of cpu, fragment")

# Names, with those that there are.
for option, names, answer in (
    ("--engine", "CPU", "choose one of cpu, fragment"), ("--solver", "strem", "stream, two-step, pca, ceres, ceres-varpro, tinysolver, tinysolver-float, als, varpro, mean"),
    ("--optimizer", "gc ''", "choose one of cg, sd, lbfgs, adam, lm"), ("--mode", "papers", "choose one of paper, modern (nearest: "),
    ("--passes", "combine", "choose one of paper, r300, combined"), ("--storage", "fp8", "choose one of fp32, fp16, fp16-truncate"),
    ("--sums", "fp16-truncate", "choose one of fp32, fp16"), ("--distributor", "gpu", "choose one of cpu, gl"),
    ("--source", "disc", "choose one of disk, disk-cold, memory, device"), ("--samples", "kept", "choose one of cached, redistributed"),
    ("--accumulate", "scatter", "choose one of gather, scatter-fixed, scatter-float"), ("--view", "linear", "choose one of bilinear, nearest"),
    ("--surface", "bilinear", "choose one of nearest, linear"),
    ("--space", "srgb", "choose one of stored, linear"), ("--record", "fat", "choose one of compact, full"),
    ("--model", "lafortun", "choose one of viewbasis, lfm, "), ("--ceres", "dense", "choose one of "),
):  # fmt: skip
    refuse(f"fit tiny {option} {{}} -o new", names, "'{}' does not exist", answer)
refuse("fit tiny --context {} -o new", "glx ''", "context '{}' does not exist; choose one of egl, osmesa")

# What means nothing to the solver, engine or model.
for solver, options in (
    ("two-step", ("--engine fragment", "--source disk", "--refills 2", "--ceres cgnr")),
    ("pca", ("--deflate", "--optimizer sd", "--mu 2", "--records r", "--seed 2")),
    ("mean", ("--terms 3", "--view-side 9", "--lambda-surface 1")),
    ("als", ("--optimizer sd", "--deflate", "--stop-change 1", "--ceres cgnr", "--sort-memory 64M")),
    ("varpro", ("--deflate", "--optimizer sd", "--record full", "--refills 1")),
    ("ceres", ("--record full", "--optimizer sd", "--stop-change 1", "--engine fragment")),
    ("stream", ("--sort-memory 64M", "--ceres cgnr", "--passes paper", "--storage fp16", "--sums fp16", "--clip-above 0.9")),
):  # fmt: skip
    for option in options:
        words = (f"{option.split()[0]} means nothing to ", "leave it out")
        rows.append((f"fit tiny --solver {solver} {option} -o new", None, 2, *words))
rows += [
    ("fit tiny --engine fragment --distributor gl -o new", None, 2, "--distributor means nothing to engine fragment"),
    ("fit tiny --engine compute --samples redistributed --distributor gl -o new", None, 2, "--distributor means nothing to engine compute"),
    ("fit tiny --engine compute --source disk -o new", None, 2, "--source means nothing to engine compute"),
    ("fit tiny --engine fragment --accumulate scatter-fixed -o new", None, 2, "--accumulate means nothing to engine fragment"),
    ("fit tiny --samples redistributed -o new", None, 2, "--samples means nothing to engine cpu"),
    ("fit flat --model lambert --engine compute --optimizer cg --samples redistributed -o new", None, 2, "--samples means nothing to model lambert"),
    ("plan tiny --engine compute --samples redistributed --texels-per-pixel 1", None, 2, "all surface maps have one side", "--samples redistributed"),
    ("plan tiny --engine fragment --distributor gl", None, 2, "--distributor means nothing to engine fragment"),
    ("fit tiny --surface linear --engine fragment -o new", None, 2, "--surface linear fits colours at texels' centres", "choose --surface nearest, or leave out --engine fragment"),
    ("plan tiny --surface linear --engine compute --samples redistributed", None, 2, "choose --surface nearest", "--samples redistributed"),
    ("fit tiny --model lfm --surface linear --distributor gl -o new", None, 2, "--distributor means nothing to "),
    ("fit flat --model lafortune --surface linear -o new", None, 2, "--surface means nothing to model lafortune"),
    ("fit tiny --optimizer lm -o new", None, 2, "optimizer lm fits texel-local models on the CPU"),
    ("fit flat --model lafortune --optimizer lm --engine fragment -o new", None, 2, "choose cg or sd, or --engine cpu"),
    ("fit flat --model lafortune --solver pca -o new", None, 2, "solver pca does not fit texel-local models", "choose one of stream, two-step, ceres, ceres-varpro, tinysolver, tinysolver-float for --model lafortune"),
    ("fit flat --model lafortune --solver als -o new", None, 2, "solver als does not fit texel-local models"),
    ("fit flat --model lafortune --solver varpro -o new", None, 2, "solver varpro does not fit texel-local models"),
    ("fit flat --model lambert --solver mean -o new", None, 2, "solver mean does not fit texel-local models"),
    ("fit flat --model lafortune --surface-side 9 -o new", None, 2, "--surface-side means nothing to model lafortune", "over a grid"),
    ("fit flat --model lafortune --distributor gl -o new", None, 2, "--distributor means nothing to ", "over a grid"),
    ("fit flat --model lafortune --terms 2 -o new", None, 2, "--terms means nothing to model lafortune"),
    ("fit flat --model lafortune --space linear -o new", None, 2, "--space means nothing to model lafortune"),
    ("fit flat --model lafortune --mu 2 -o new", None, 2, "--mu means nothing to model lafortune with optimizer lm"),
    ("fit flat --model lafortune --lambda-view 1 -o new", None, 2, "--lambda-view means nothing to "),
    ("fit flat --model lafortune --solver ceres --optimizer sd -o new", None, 2, "--optimizer means nothing to "),
    ("fit orb --model lafortune --surface-side 7 -o new", None, 2, "its normals were made for surface side", "fit with --surface-side"),
    ("fit tiny --model lafortune -o new", None, 2, "no image says what lit it", "--model lfm"),
    ("plan tiny --model lafortune", None, 2, "no image says what lit it"),
    ("fit flat --model lfm -o new", None, 2, "flat: a grid of texels", "made for reflectance models"),
    ("plan flat --model lfm", None, 2, "flat: a grid of texels", "made for reflectance models"),
    ("fit orb --model lfm -o new", None, 2, "made for reflectance models"),
    ("fit tiny --leave-out nobody -o new", None, 2, "leave-out: tiny has no training image 'nobody'", "--per-image"),
    ("judge fit --beside nobody", None, 2, "beside 'nobody'", "lumigraph"),
    ("fit tiny --leave-out a --leave-out-outliers -o new", None, 2, "--leave-out-outliers finds images itself"),
    ("fit tiny --leave-out-outliers --shard 1/2 -o new", None, 2, "--leave-out-outliers fits in one piece"),
    ("tune tiny --seconds 0", None, 2, "seconds"),
    ("tune tiny --validation 1", None, 2, "validation = 1"),
    ("tune missing", None, 2, "missing"),
    ("fit tiny --validation 3 -o new", None, 2, "validation = 3: tiny has 2 training views; choose fewer"),
    ("fit flat --model lafortune --clip-above 1e-6 -o new", None, 2, "no sample is left to fit", "choose a larger --clip-above"),
    ("fit tiny --engine fragment --context egl --device 99 -o new", None, 2, "--device", "out of range", "radiafit devices"),
    ("fit tiny --engine fragment --context osmesa --device 99 -o new", None, 2, "--device", "out of range", "radiafit devices"),
    # A driver that is too old.
    *((f"MESA_GL_VERSION_OVERRIDE=3.3 MESA_GLSL_VERSION_OVERRIDE=330 fit tiny {more} -o new", None, 2,
       "offers OpenGL 3.3, but 4.5 core is needed", "update the driver, or choose another --context")
      for more in ("--engine fragment", "--engine fragment --context osmesa", "--distributor gl")),
    # Every solver accepts the same small dataset.
    ("fit tiny --solver two-step --iterations 1 -o new", None, 0, "see new"),
    ("fit tiny --solver pca -o new", None, 0, "see new"),
    ("fit tiny --solver ceres --iterations 1 -o new", None, 0, "see new"),
    ("fit tiny --solver als --iterations 1 -o new", None, 0, "see new"),
    ("fit tiny --solver varpro --iterations 1 -o new", None, 0, "see new"),
    ("fit tiny --solver mean -o new", None, 0, "see new"),
    ("fit tiny --engine fragment --iterations 1 -o new", None, 0, "see new"),
    ("fit flat --model lafortune -o new", None, 0, "see new"),
    ("fit flat --model ptm --solver ceres --iterations 2 -o new", None, 0, "see new"),
    ("fit flat --model lambert --engine fragment --optimizer cg --iterations 1 -o new", None, 0, "see new"),
]

# generate
refuse("generate {} -o new", "cube ''", 'unknown shape "{}"; there are star, bust and ornament')
refuse("generate star --scale {} -o new", "huge", 'unknown scale "{}"; there are smoke, standard and paper')
refuse("generate star --seed {} -o new", "-1 ''", "seed = '{}': choose a whole number from 0")
refuse("generate ornament --encoding {} -o new", "u8-linear", "encoding '{}' does not exist; choose one of u8-srgb, u16-linear, f32-linear")
refuse("generate ornament --shading {} -o new", "phong", "shading '{}' does not exist; choose one of texel, pixel")
refuse("generate ornament --light {} -o new", "far", "light '{}' does not exist; choose one of distant, near")
for noise in ("read-noise", "shot-noise"):
    refuse(f"generate ornament --{noise} {{}} -o new", "-0.1 nan", f"{noise} = ", "choose a number from 0 to 1 (white is 1)")
    rows.append((f"generate star --{noise} 0.1 -o new", None, 2, "the ornament's to choose, not the star's", "leave these options out"))
rows.append(("generate bust --shading pixel -o new", None, 2, "the ornament's to choose, not the bust's"))
accept("generate star --seed 18446744073709551615 -o new", "star")

# judge, render, info
refuse("judge fit --split {}", "all", "split '{}' does not exist; choose one of train, test, validation")
rows += [
    ("judge fit --split validation", None, 2, "--split validation: the fit left no view out", "--validation N"),
    ("judge fit --split train", None, 0, "PSNR"),
    ("judge fit --json", None, 0, "psnr"),
]
refuse("render fit --view {} -o new", "-1 two ''", "view = ", "choose a whole number from 0")
refuse("render fit --view {} -o new", "3", "--view {}: tiny has views 0 to 2")
refuse("render fit --turntable {} -o new", "0 10001 x", "turntable = ", "choose a whole number from 1 to 10000")
refuse("render fit --size {} -o new", "9 9x x9 0x9 9x8193 9x9x9 axb -1x4 99999999999999999999x1", "size = ")
refuse("render fit --background {} -o new", "red 1 1,2 1,2,256 -1,2,3 1,2,3,4 1,,3 nan,0,0", "background = ")
refuse("render fit --turntable 2 --video {}", "new.avi new .mp4", "--video {}: name a file that ends in .mp4 or .webm")
refuse("render flatfit --light {} -o new", "0,0,0 nan,0,1 inf,0,1 1e300,0,0", "--light", "a direction's length is finite and not 0")
refuse("render flatfit --raking {} -o new", "0 91 x nan", "raking = ", "choose a number from 0.1 to 90")
refuse("render flatfit --raking 15 --directions {} -o new", "0 361 x", "directions = ", "choose a whole number from 1 to 360")
refuse("render flatfit --enhance {} -o new", "glossy 1 1,2", "enhance = '{}': give KD,KS,EXPONENT")
refuse("render flatfit --enhance {} -o new", "-1,1,75 1,nan,75 11,1,75 1,1,0.5 1,1,75,2 ,,", "enhance = ", "choose a number from ")
refuse("render flatfit --light {} -o new", "1,2 a,b,c 1,2,3,4", "--light")
refuse("publish fit --megabytes {} -o new", "0 x 10001", "megabytes = ", "choose a number from 0.1 to 10000")
refuse("publish fit --fidelity {} -o new", "19 x 101", "fidelity = ", "choose a number from 20 to 100")
refuse("publish fit --views {} -o new", "0 x 1001", "views = ", "choose a whole number from 1 to 1000")
refuse("publish fit --scale {} -o new", "mm 1 long nanm xmm 1parsec 1.5MM 1mmm", "scale = ", "give a number above 0 and its unit")
refuse("publish fit --scale {} -o new", "0mm -1mm 1e10m 1..5m 1,5m", "scale = ", "choose a number from 1e-09 to 1e+09")
rows += [
    ("publish fit -o fit", None, 2, "fit: is no page of radiafit"),
    ("publish fit --single-file -o fit/fit.json", None, 2, "fit/fit.json: is there, and is no page"),
    ("render fit --view 1 --turntable 2 -o new", None, 2, "--turntable", "--view"),
    ("render fit --problems -o new", None, 2, "--problems: those of a light field map are vertices"),
    ("render fit --light 0,0,1 -o new", None, 2, "--light: this fit's model keeps the light", "light field map", "--model lightbasis"),
    ("render flatfit --turntable 2 --light 0,0,1 -o new", None, 2, "--light", "the lamp that --turntable moves"),
    ("render flatfit --size 9x9 -o new", None, 2, "--size: over a grid"),
    ("render fit --full-circle -o new", None, 2, "--full-circle says nothing without --turntable"),
    ("render fit --video new.mp4", None, 2, "--video says nothing without --turntable"),
    ("PATH=/nowhere render fit --turntable 2 --video new.mp4", None, 2, "new.mp4: ffmpeg is missing", "apt-get install ffmpeg"),
    ("render fit --turntable 2 --video new.mp4 --background transparent", None, 2, "new.mp4: .mp4 has no transparency"),
    ("render fit --view 1 --video new.mp4", None, 2, "--video says nothing without --turntable or --raking"),
    ("render fit --raking 15 -o new", None, 2, "--raking: this fit's model keeps the light"),
    ("render fit --enhance specular -o new", None, 2, "--enhance: this fit's model keeps the light"),
    ("render flatfit --directions 8 -o new", None, 2, "--directions says nothing without --raking"),
    ("render flatfit --raking 15 --light 0,0,1 -o new", None, 2, "--raking", "--light"),
    ("render flatfit --raking 15 --turntable 2 -o new", None, 2, "--raking", "--turntable"),
    ("render flatfit --enhance specular --all train -o new", None, 2, "--enhance", "--all"),
    ("render flatfit --raking 15 --directions 2 --enhance 0.4,0.7,75 -o new", None, 0, "raking_180_bottom"),
    ("render flatfit --problems --size 9x9 -o new", None, 2, "--problems", "--size"),
    ("render flatfit --turntable 2 -o new", None, 0, "turn001"),
    ("render fit --turntable 2 --full-circle --size 40x30 --background 1,2,3 -o new", None, 0, "turn001", "a full circle"),
    ("render flatfit --problems --light 0,0,1 -o new", None, 2, "--problems", "--light"),
    ("render fit --all some -o new", None, 2, "all 'some'", "held-out"),
    ("render fit --all train --view 1 -o new", None, 2, "--all", "--view"),
    ("render fit --view 2 -o new", None, 0, "new.png"),
    ("render fit --turntable 1 -o new", None, 0, "turn000"),
    ("render flatfit --light 0,3e30,4e30 -o new", None, 0, "new.png"),
    ("info tiny --dataset tiny", None, 2, "--dataset tiny: tiny is no fit; leave it out"),
    ("info fit --json", None, 0, '"kind": "fit"'),
    ("info tiny --json", None, 0, '"kind": "dataset"'),
    ("devices", None, 0, "cpu"),
]

# import
refuse("import colmap --model photos/text --images photos/images --mesh photos/mesh.obj --max-size {} -o new", "-1 65537 x", "max-size = ", "choose a whole number from 0 to 65536 (0 keeps the size)")
refuse("import colmap --model photos/text --images photos/images --mesh photos/mesh.obj --least-coverage {} -o new", "-0.1 1.1 nan x", "least-coverage = ", "choose a number from 0 to 1 (0 is off)")
refuse("import colmap --model photos/text --images photos/images --mesh photos/mesh.obj --holdout {} -o new", "every:1 every:x every: every:-2 every:99999999999999999999", "--holdout {}: N is to be a whole number from 2 on")
refuse("import colmap --model photos/text --images photos/images --mesh photos/mesh.obj --holdout {} -o new", "nowhere.txt evry:3", "{}: no such list of held-out images")
refuse("import colmap --model photos/text --images photos/images --mesh photos/mesh.obj --gains {} -o new", "guess nowhere.txt", "{}: no such gain table")
lights = "import lights --images lit/images --lights lit/lights.txt"
refuse(f"{lights} --depth {{}} -o new", "7 x", "depth '{}' does not exist; choose one of 8, 16, 32")
refuse(f"{lights} --depth {{}} -o new", "16 32", "lit/images/0.png: ", "--depth {} was declared")
refuse(f"{lights} --max-size {{}} -o new", "-1 65537 x", "max-size = ", "choose a whole number from 0 to 65536 (0 keeps the size)")
refuse(f"{lights} --transfer {{}} -o new", "gamma", "--transfer {}: choose auto, linear or srgb")
refuse(f"{lights} --light-axes {{}} -o new", "y x,x,z x,y x,y,z,x x,w,z", "--light-axes {}: give the file's axes that the world's x, y and z are, each axis once, such as x,-y,z")
refuse(f"{lights} --holdout {{}} -o new", "every:1", "--holdout {}: N is to be a whole number from 2 on")
refuse("import lights --images lit/images --light-positions lit/places.txt --sample-width {} -o new", "0 nan 1e10", "sample-width = ", "choose a number from 1e-09 to 1e+09")
for option in ("sphere-radius", "refine-lamps"):
    refuse(f"{lights} --{option} {{}} -o new", "0 nan 1e10", f"{option} = ", "choose a number from ")
refuse("import lights --images lit/images --spheres {} -o new", "auto:0 auto:x auto:99 auto:", "--spheres auto:N = ", "choose a whole number from 1 to 20")
rows += [
    (f"{lights} --spheres auto -o new", None, 2, "or as places (--light-positions), or have them found by glossy spheres in the images (--spheres)"),
    (f"{lights} --sphere-radius 3 -o new", None, 2, "--sphere-radius says how large things are by the spheres (--spheres): leave it out"),
    ("import lights --images lit/images --spheres auto --sphere-radius 3 --sample-width 9 -o new", None, 2, "--sphere-radius says how large", "leave it or --sample-width out"),
    ("import lights --images lit/images --spheres auto --camera-positions lit/eyes.txt -o new", None, 2, "give --sample-width"),
    ("import lights --images lit/images --spheres auto --by-order -o new", None, 2, "--spheres: names no images", "leave --by-order out"),
    ("import lights --images lit/images --spheres auto --light-axes x,-y,z -o new", None, 2, "--light-axes means nothing with --spheres"),
    ("import lights --images lit/images --spheres auto --refine-lamps 2 -o new", None, 2, "--refine-lamps means nothing with --spheres"),
    (f"{lights} --refine-lamps 2 -o new", None, 2, "lit/images: 4 images are too few for --refine-lamps, which takes 6"),
    (f"{lights} --sample-width 3 -o new", None, 2, "--sample-width says nothing about directions"),
    (f"{lights} --light-positions lit/places.txt -o new", None, 2, "either as directions (--lights) or as places (--light-positions)"),
    ("import lights --images lit/images -o new", None, 2, "either as directions (--lights) or as places (--light-positions)"),
    ("import lights --images lit/images --light-positions lit/places.txt -o new", None, 2, "give --sample-width"),
    (f"{lights} --camera-positions lit/eyes.txt -o new", None, 2, "give --sample-width"),
    ("import lights --images lit/images --lights lit/dome.lp --names lit/names.txt -o new", None, 2, "names its images itself: leave --names out"),
    (f"{lights} -o new", None, 0, "6 x 5"),
    (f"{lights} --light-axes x,-y,z -o new", None, 0, "6 x 5"),
    ("import lights --images lit/images --lights lit/dome.lp -o new", None, 0, "6 x 5"),
    ("import lights --images lit/images --light-positions lit/places.txt --camera-positions lit/eyes.txt --sample-width 6 -o new", None, 0, "6 x 5"),
]

# Empty names, for every option that takes one.
colmap = "--model photos/text --images photos/images --mesh photos/mesh.obj"
for command, name in (
    ("generate star -o ''", "output"), ("fit tiny -o ''", "output"), (f"import colmap {colmap} -o ''", "output"),
    (f"{lights} -o ''", "output"), ("render fit -o ''", "output"), ("render fit --turntable 1 -o ''", "output"),
    ("fit '' -o new", "dataset"), ("plan ''", "dataset"), ("info ''", "folder"), ("judge ''", "fit"), ("render '' -o new", "fit"),
    ("judge fit --dataset ''", "dataset"), ("render fit --dataset '' -o new", "dataset"), ("info fit --dataset ''", "dataset"),
    ("render fit --turntable 2 --video ''", "video"),
    ("fit tiny --solver two-step --records '' -o new", "records"),
    (f"import colmap --model '' {colmap.split(' ', 2)[2]} -o new", "model"), (f"import colmap {colmap} --masks '' -o new", "masks"),
    (f"import colmap {colmap} --gains '' -o new", "gains"), (f"import colmap {colmap} --holdout '' -o new", "held-out"),
    (f"{lights} --mask '' -o new", "mask"), (f"{lights} --normals '' -o new", "normals"), (f"{lights} --names '' -o new", "names"),
    (f"{lights} --light-axes '' -o new", "light-axes"),
    (f"{lights} --intensities '' -o new", "intensities"), (f"{lights} --spheres '' -o new", "spheres"), ("import lights --images '' --lights lit/lights.txt -o new", "images"),
):  # fmt: skip
    rows.append((command, None, 2, f"{name} = '': give a name"))

# Command lines as a whole.
rows += [
    ("", None, 2, "subcommand", "see radiafit --help"),
    ("gnerate star -o new", None, 2, "command 'gnerate' does not exist", "nearest: generate"),
    ("fitt tiny -o new", None, 2, "command 'fitt' does not exist", "nearest: fit"),
    ("tiny", None, 2, "command 'tiny' does not exist", "choose one of generate, "),
    ("import", None, 2, "subcommand"),
    ("import colmp --model photos/text -o new", None, 2, "command 'colmp' does not exist", "nearest: colmap"),
    ("fit tiny --itterations 3 -o new", None, 2, "option '--itterations' does not exist", "nearest is --iterations", "see radiafit fit --help"),
    ("fit tiny --itterations=3 -o new", None, 2, "option '--itterations=3' does not exist", "nearest is --iterations"),
    ("fit tiny -q -o new", None, 2, "option '-q' does not exist"),
    ("generate star --scal smoke -o new", None, 2, "nearest is --scale"),
    ("judge fit --jsn", None, 2, "nearest is --json"),
    ("--thread 2 devices", None, 2, "nearest is --threads"),
    ("fit tiny", None, 2, "--output is required", "see radiafit fit --help"),
    ("fit -o new", None, 2, "dataset is required"),
    ("plan", None, 2, "dataset is required"),
    ("judge", None, 2, "fit is required"),
    ("render fit", None, 2, "--output is required", "see radiafit render --help"),
    ("publish fit", None, 2, "--output is required", "see radiafit publish --help"),
    ("generate -o new", None, 2, "shape is required"),
    ("generate star", None, 2, "--output is required"),
    ("import colmap -o new", None, 2, "is required"),
    ("import lights -o new", None, 2, "--images is required"),
    ("info", None, 2, "folder is required"),
    ("fit tiny fit -o new", None, 2, "'fit' is one argument too many"),
    ("devices everything", None, 2, "'everything' "),
    ("fit tiny --terms -o new", None, 2, "terms = '-o'"),
    ("fit tiny -o", None, 2, "--output"),
    ("fit tiny --terms 1 --terms 2 -o new", None, 2, "--terms"),
    ("fit tiny -o new -o newer", None, 2, "--output"),
    ("judge fit --json=maybe", None, 2, "--json"),
    ("--version", None, 0, "radiafit "),
    ("--help", None, 0, "generate"),
    ("fit --help", None, 0, "--lambda-surface"),
]

# export
problems = "export problems tiny"
for option, words in (
    ("--solver als", "option '--solver' does not exist"), ("--loss huber", "option '--loss' does not exist"),
    ("--iterations 3", "option '--iterations' does not exist"), ("--clip-above 0.5", "--clip-above means nothing to"),
    ("--model lambert --terms 2", "--terms means nothing to model lambert"), ("--model lambert", "tiny: "),
    ("--surface-side 1", "surface-side = 1: choose"), ("--validation 1000", "validation = 1000: tiny has"),
    ("--texels-per-pixel 1 --surface-side 4", "leave out --surface-side"), ("--texels-per-pixel 1 --distributor gl", "all surface maps have one side"),
):  # fmt: skip
    rows.append((f"{problems} {option} -o new", None, 2, words))
rows += [
    ("export", None, 2, "subcommand is required"),
    ("export problems", None, 2, "required"),
    (problems, None, 2, "--output is required"),
    ("export problems flat -o new", None, 2, "flat: "),
    ("export problems nowhere -o new", None, 2, "nowhere: "),
    ("export problems tiny -o tiny", None, 2, "tiny: is there already, made by radiafit import colmap; radiafit export problems replaces only what it made: remove it"),
    ("export problems tiny -o ''", None, 2, "output = '': give a name"),
    ("export parameters tiny -o new", None, 2, "tiny/fit.json: no such file"),
    ("export parameters nowhere -o new", None, 2, "nowhere: no such folder"),
    ("export parameters fit -o fit", None, 2, "fit: is there already, made by `radiafit fit tiny "),
    ("export parameters fit --dataset flat -o new", None, 2, "flat: differs from the dataset that was fitted"),
    ("export gltf", None, 2, "required"),
    ("export gltf fit", None, 2, "--output is required"),
    ("export gltf tiny -o new.glb", None, 2, "tiny/fit.json: no such file"),
    ("export gltf nowhere -o new.glb", None, 2, "nowhere: no such folder"),
    ("export gltf fit -o ''", None, 2, "output = '': give a name"),
    ("export gltf fit -o new", None, 2, "new: name a file that ends in .glb"),
    ("export gltf fit --dataset flat -o new.glb", None, 2, "flat: differs from the dataset that was fitted"),
    ("export rti fit -o new", None, 2, "fit: its model keeps the light it was photographed under"),
    ("export rti flatfit --view 1000 -o new", None, 2, "--view 1000: "),
    ("export rti flatfit --quality 0 -o new", None, 2, "quality = 0: choose a whole number from 1 to 100"),
    ("export rti flatfit --quality 101 -o new", None, 2, "quality = 101: choose a whole number from 1 to 100"),
    ("export rti flatfit -o fit", None, 2, "fit: holds ", "which is no part of an RTI export"),
    ("export rti tiny -o new", None, 2, "tiny/fit.json: no such file"),
    ("export maps fit -o fit", None, 2, "fit: holds ", "which is no part of exported maps"),
    ("export maps fit -o photos/mesh.obj", None, 2, "photos/mesh.obj: a file is there"),
    ("export maps nowhere -o new", None, 2, "nowhere: no such folder"),
    ("export maps fit --normals fit -o new", None, 2, "fit: its model keeps the light it was photographed under"),
    ("export maps flatfit --normals both -o new", None, 2, "normals 'both' does not exist"),
    ("export gltf fit -o new.glb", None, 0, "new.glb: "),
    ("export gltf flatfit -o new.glb", None, 0, "new.glb: "),
    ("export rti flatfit -o new", None, 0, "new/info.json: 6 x 5 pixels"),
    ("export maps fit -o new", None, 0, "new: textures of "),
    ("export maps flatfit -o new", None, 0, "new: textures of 6 x 5 pixels"),
    ("export maps flatfit --normals fit -o new", None, 0, "normals: by photometric stereo"),
    (f"{problems} -o new", None, 0, "problems of lfm: new"),
    ("export problems flat --model lafortune -o new", None, 0, "problems of lafortune: new"),
    ("export parameters fit -o new", None, 0, "parameters of fit: new"),
    ("export parameters flatfit -o new", None, 0, "parameters of flatfit: new"),
]
