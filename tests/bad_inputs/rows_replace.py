"""Finished outputs: each command that writes says that its own is done, and leaves that of another one, which takes --replace."""
from bad_inputs.damage import cut, remove, write
from bad_inputs.fixtures import MADE, UNMADE

rows = []
for command, output, other in MADE:
    others = other if other.startswith(command.split()[0]) else f"{command} {other}"  # options, or a whole command
    rows += [
        (f"{command} -o {output}", None, 0, f"{output}: done already, by this command on the same input; --replace does it again"),
        (f"{others} -o {output}", None, 2, f"{output}", "is there already, made by ", "--replace puts this one in its place, or choose another name"),
        (f"{others} -o {output} --replace", None, 0),
    ]
for command, output, *words in UNMADE:
    rows.append((f"{command} -o {output}", None, 2, f"{output}", "nothing says which command made it", *words))
rows += [
    # What is no longer as it was made
    ("generate ornament -o orb", cut("orb/images.bin", 0.5), 2, "orb: is there already, made by this command, but changed since; --replace"),
    ("generate ornament -o orb", remove("orb/normals.f32"), 2, "orb: is there already, made by this command, but changed since"),
    ("generate ornament -o orb", write("orb/.radiafit-made.json", "no JSON"), 2, "orb: is there already, and nothing says which command made it"),
    ("generate ornament -o orb", write("orb/.radiafit-made.json", '{"format": "radiafit-made", "version": 1}'), 2, "orb: is there already, and nothing says"),
    ("generate ornament -o orb", remove("orb/.radiafit-made.json"), 2, "orb: is there already, and nothing says"),
    ("generate ornament -o orb --replace", remove("orb/.radiafit-made.json"), 0, "dataset "),
    # What other commands made stays in any case
    ("export problems tiny -o tiny --replace", None, 2, "tiny: is there already, made by radiafit import colmap; radiafit export problems replaces only what it made"),
    ("capture masks photos/mesh.obj --model photos/text -o fit --replace", None, 2, "fit: is there already, made by `", "replaces only what it made"),
    ("render wholefit --turntable 1 -o wholefit --replace", None, 2, "wholefit: is there already, made by `", "replaces only what it made"),
    # A folder that many pictures share with other things
    ("render fit --turntable 1 -o made/page", None, 0, "turntable: "),
    ("render fit --turntable 1 -o made/shared", write("made/shared/turn000.png", "radiafit_render"), 2, "made/shared/turn000.png: is there already"),
    # Shards go on from what is there
    ("fit tiny --terms 1 --iterations 1 --shard 1/1 -o made/shard", None, 0),
    ("fit tiny --terms 1 --iterations 1 --shard 1/1 -o made/shard --replace", None, 2, "--replace is of whole fits"),
    ("fit tiny --terms 2 --iterations 1 --shard 1/1 -o made/shard", None, 2, "made/shard: holds ", "choose another folder"),
]
