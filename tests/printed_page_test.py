#!/usr/bin/env python3
"""A page of docs/ is what a program prints. Arguments: the page's name, the program and its arguments."""
import pathlib
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / sys.argv[1]
printed = subprocess.run(sys.argv[2:], stdout=subprocess.PIPE, check=True, text=True).stdout
if printed != PAGE.read_text():
    sys.exit(f"{PAGE} is not what the program prints: {' '.join(sys.argv[2:])} > docs/{sys.argv[1]}")
