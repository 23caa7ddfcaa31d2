#!/usr/bin/env python3
"""Plays COLMAP for tests/capture_script_test.py: the commands that datasets/scripts/capture.sh calls, answered from a folder
that FAKE_COLMAP names, with `model` (binary, with points) and `mesh.ply`. FAKE_COLMAP_KEEPS: how many photographs it
registers, FAKE_COLMAP_FEATURES: how many features it finds in each, FAKE_COLMAP_FAILS and FAKE_COLMAP_WAITS: the command that
fails, or waits for a signal.
"""
import os
import pathlib
import shutil
import struct
import sys
import time

truth = pathlib.Path(os.environ["FAKE_COLMAP"])
command, options = sys.argv[1], dict(zip(sys.argv[2::2], sys.argv[3::2]))


def path(name):
    return pathlib.Path(options["--" + name])


def write_model(out, keeps):
    """The model, with its first photographs alone."""
    out.mkdir(parents=True)
    shutil.copy(truth / "model/cameras.bin", out)
    data, at = (truth / "model/images.bin").read_bytes(), 8
    ends = []
    while at < len(data):
        at = data.index(b"\0", at + 64) + 1 + 8
        ends.append(at)
    keeps = min(keeps, len(ends))
    (out / "images.bin").write_bytes(struct.pack("<Q", keeps) + data[8 : ends[keeps - 1] if keeps else 8])
    points, at, kept = (truth / "model/points3D.bin").read_bytes(), 8, []
    while at < len(points):
        (length,) = struct.unpack_from("<Q", points, at + 43)
        track = [struct.unpack_from("<2I", points, at + 51 + 8 * i) for i in range(length)]
        track = [pair for pair in track if pair[0] <= keeps]
        if len(track) >= 2:
            kept.append(points[at : at + 43] + struct.pack("<Q", len(track)) + b"".join(struct.pack("<2I", *pair) for pair in track))
        at += 51 + 8 * length
    (out / "points3D.bin").write_bytes(struct.pack("<Q", len(kept)) + b"".join(kept))


if command == os.environ.get("FAKE_COLMAP_FAILS"):
    sys.exit("out of memory")
if command == os.environ.get("FAKE_COLMAP_WAITS"):
    print("matching", flush=True)
    time.sleep(60)
if command == "feature_extractor":
    for _ in path("image_path").iterdir():
        print("  Features:        " + os.environ.get("FAKE_COLMAP_FEATURES", "900"))
    path("database_path").write_text("features")
elif command == "exhaustive_matcher":
    path("database_path").write_text("features and matches")
elif command == "mapper":
    assert path("database_path").read_text() == "features and matches"
    keeps = int(os.environ.get("FAKE_COLMAP_KEEPS", "1000000"))
    if keeps:
        write_model(path("output_path") / "1", keeps)
        write_model(path("output_path") / "0", 1)
elif command == "image_undistorter":
    shutil.copytree(path("input_path"), path("output_path") / "sparse")
    shutil.copytree(path("image_path"), path("output_path") / "images")
    (path("output_path") / "stereo").mkdir()
elif command == "model_converter":
    path("output_path").write_text("points")
elif command == "stereo_fusion":
    for name in (path("workspace_path") / "stereo/fusion.cfg").read_text().splitlines():
        assert (path("workspace_path") / f"stereo/depth_maps/{name}.geometric.bin").exists()
        assert (path("workspace_path") / f"images/{name}").exists()
    path("output_path").write_text("points")
elif command == "poisson_mesher":
    assert path("input_path").read_text() == "points"
    shutil.copy(truth / "mesh.ply", path("output_path"))
else:
    sys.exit(f"fake_colmap.py: no such command: {command}")
