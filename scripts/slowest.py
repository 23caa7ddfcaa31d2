#!/usr/bin/env python3
"""What took longest: the units of a build as Ninja last compiled them, and the tests and their cases of its last run of CTest.
Usage: slowest.py BUILD [COUNT]"""
import pathlib
import re
import sys
import xml.etree.ElementTree


def units(build):
    """{object: seconds} of what Ninja's log has last."""
    found = {}
    for line in (build / ".ninja_log").read_text().splitlines()[1:]:
        start, end, _, output, _ = line.split("\t")
        if output.endswith((".o", ".gch")):
            found[re.sub(r"CMakeFiles/[^/]*\.dir/|\.o$", "", output)] = (int(end) - int(start)) / 1000
    return found


def tests(build):
    log = build / "Testing" / "Temporary" / "LastTest.log"
    text = log.read_text(errors="replace") if log.exists() else ""
    times = re.findall(r"^\d+/\d+ Testing: (\S+)$.*?^Test time = +([\d.]+) sec$", text, re.M | re.S)
    return {name: float(seconds) for name, seconds in times}


def cases(build):
    found = {}
    for file in (build / "Testing" / "cases").glob("*.xml"):
        for case in xml.etree.ElementTree.parse(file).iter("testcase"):
            found[f"{file.stem}: {case.get('classname')}.{case.get('name')}"] = float(case.get("time"))
    return found


def main():
    build, count = pathlib.Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 20
    for what, found in (("units to compile", units(build)), ("tests", tests(build)), ("cases of test programs", cases(build))):
        if found:
            print(f"slowest {what}, of {len(found)} that took {sum(found.values()):.0f} s one after another:")
        for name, seconds in sorted(found.items(), key=lambda item: -item[1])[:count]:
            print(f"{seconds:8.1f} s  {name}")


if __name__ == "__main__":
    main()
