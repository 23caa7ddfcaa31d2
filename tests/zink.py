#!/usr/bin/env python3
"""A second OpenGL: Mesa's zink, which hands all on to Vulkan, over lavapipe, Vulkan in software.

As a program: zink.py RADIAFIT PROGRAM [ARGUMENTS] runs the program on it. Exit status: the program's; 77 (skipped) where there is
no lavapipe; 1 where OpenGL is another one all the same."""
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile


def environment():
    """What chooses it, or None where lavapipe is not installed."""
    driver = pathlib.Path("/usr/share/vulkan/icd.d") / f"lvp_icd.{platform.machine()}.json"
    if not driver.exists():
        return None
    return {"GALLIUM_DRIVER": "zink", "LIBGL_ALWAYS_SOFTWARE": "1", "VK_ICD_FILENAMES": str(driver), "VK_DRIVER_FILES": str(driver),
            "XDG_RUNTIME_DIR": tempfile.gettempdir()}


def renderer(radiafit, more):
    """What EGL's software renderer says that it is, with more of an environment."""
    said = subprocess.run([radiafit, "devices", "--json"], env={**os.environ, **more}, capture_output=True, text=True, check=True)
    return next(d for d in json.loads(said.stdout)["devices"] if d["name"].startswith("egl") and d.get("kind") == "software")["renderer"]


def main():
    radiafit, *command = sys.argv[1:]
    more = environment()
    if more is None:
        print("skipped: no lavapipe here (scripts/install-packages.sh installs it: mesa-vulkan-drivers)")
        return 77
    named = renderer(radiafit, more)
    if not named.startswith("zink"):
        print(f"OpenGL is {named}, not zink")
        return 1
    print(f"on {named}", flush=True)
    os.execve(command[0], command, {**os.environ, **more})


if __name__ == "__main__":
    sys.exit(main())
