#!/usr/bin/env python3
"""docs/options.md is what `radiafit options` prints. Arguments: the program."""
import pathlib
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "options.md"
printed = subprocess.run([sys.argv[1], "options"], stdout=subprocess.PIPE, check=True, text=True).stdout
if printed != PAGE.read_text():
    sys.exit(f"{PAGE} is not what the program prints: radiafit options > docs/options.md")
