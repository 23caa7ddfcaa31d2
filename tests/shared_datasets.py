#!/usr/bin/env python3
"""Makes the datasets that the tests of programs share (cli_fixture.SHARED). Arguments: the program, their folder."""
import shutil
import subprocess

from cli_fixture import SHARED, take_arguments

if __name__ == "__main__":
    program, folder = take_arguments(2)
    shutil.rmtree(folder, ignore_errors=True)
    for name, arguments in SHARED.items():
        subprocess.run([program, "generate", *arguments, "-o", folder / name], check=True)
