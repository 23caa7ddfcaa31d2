#!/usr/bin/env python3
"""A second OpenGL: Mesa's zink, which hands all on to Vulkan, over lavapipe, Vulkan in software.

As a program: zink.py [--validated] RADIAFIT PROGRAM [ARGUMENTS] runs the program on it; validated: below Vulkan's validation
layers, which may say nothing but what is known of Mesa. Exit status: the program's; 77 (skipped) where lavapipe or the layers
are not installed; 1 where OpenGL is another one all the same, or the layers say anything else."""
import collections
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile


# What Mesa 22.3's zink does amiss, by the layers' identifiers. OpenGL has none of what these are about.
KNOWN = {
    # It loses track of an image's layout where a pass reads the texture that it draws to (glTextureBarrier), and where a texture
    # is sampled after it was downloaded.
    "UNASSIGNED-CoreValidation-DrawState-InvalidImageLayout", "VUID-VkDescriptorImageInfo-imageLayout-00344",
    "VUID-vkCmdDrawMultiEXT-None-02699", "VUID-vkCmdDrawMultiIndexedEXT-None-02699",
    # It declares buffers of floats as such of whole numbers, also where floats are added by atomics (--accumulate float).
    "UNASSIGNED-CoreValidation-Shader-InconsistentSpirv",
}
LAYER = pathlib.Path("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json")


def environment():
    """What chooses it, or None where lavapipe is not installed."""
    driver = pathlib.Path("/usr/share/vulkan/icd.d") / f"lvp_icd.{platform.machine()}.json"
    if not driver.exists():
        return None
    return {"GALLIUM_DRIVER": "zink", "LIBGL_ALWAYS_SOFTWARE": "1", "VK_ICD_FILENAMES": str(driver), "VK_DRIVER_FILES": str(driver),
            "XDG_RUNTIME_DIR": tempfile.gettempdir()}


def renderer(radiafit, more):
    """What EGL's software renderer says that it is, with more of an environment."""
    plain = {name: value for name, value in os.environ.items() if name != "force_gl_renderer"}
    said = subprocess.run([radiafit, "devices", "--json"], env={**plain, **more}, capture_output=True, text=True, check=True)
    return next(d for d in json.loads(said.stdout)["devices"] if d["name"].startswith("egl") and d.get("kind") == "software")["renderer"]


def validated(command, more):
    layer = "VK_LAYER_KHRONOS_validation"
    result = subprocess.run(command, env={**os.environ, **more, "VK_INSTANCE_LAYERS": layer, "VK_LOADER_DEBUG": "layer"},
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    said = collections.Counter(re.findall(r"Validation (?:Error|Warning): \[ (\S+) \]", result.stdout))
    for name, count in said.most_common():
        print(f"{count} times {name}{', known of Mesa' if name in KNOWN else ''}")
    loaded = re.search(rf"(?i)insert instance layer \"?{layer}", result.stdout)
    if not loaded:
        print(f"{layer} was not loaded")
    if result.returncode or said.keys() - KNOWN:
        print(result.stdout)
    return result.returncode or (0 if loaded and not said.keys() - KNOWN else 1)


def main():
    arguments = sys.argv[1:]
    validate = arguments[0] == "--validated"
    radiafit, *command = arguments[1:] if validate else arguments
    more = environment()
    if more is None or (validate and not LAYER.exists()):
        print("skipped: scripts/install-packages.sh installs what is missing: mesa-vulkan-drivers or vulkan-validationlayers")
        return 77
    named = renderer(radiafit, more)
    if not named.startswith("zink"):
        print(f"OpenGL is {named}, not zink")
        return 1
    print(f"on {named}", flush=True)
    if validate:
        return validated(command, more)
    os.execve(command[0], command, {**os.environ, **more})


if __name__ == "__main__":
    sys.exit(main())
