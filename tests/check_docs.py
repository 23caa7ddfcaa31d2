#!/usr/bin/env python3
"""What the documentation points at is there: relative links of README.md, CONTRIBUTING.md and docs/*.md, headings included;
and in docs/paper.md every file between backticks, and behind a colon the name that stands in it, or the test.

    `src/a/b.h`                 a file or folder
    `src/a/b.h: name`           and the name within, as a whole word
    `tests/a_test.cpp: A.B`     and TEST(A, B), TEST_F or TEST_P within
Usage: check_docs.py [ROOT]"""
import pathlib
import re
import sys

LINK = re.compile(r"\]\(([^)\s]+)\)")
CITED = re.compile(r"`((?:src|shaders|tests|experiments|examples|docs|cmake|scripts|datasets|paper_figs|results)/[^`]*)`")
CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.M | re.S)


def anchors(text):
    """Of a page's headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r"^#+ (.+)$", text, re.M):
        found.add(re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-"))
    return found


def pages(root):
    return [path for path in (root / "README.md", root / "CONTRIBUTING.md") if path.exists()] + sorted((root / "docs").glob("*.md"))


def line_of(text, at):
    return text.count("\n", 0, at) + 1


def bad_links(root, page):
    text = page.read_text(encoding="utf-8")
    plain = CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    for link in LINK.finditer(plain):
        if re.match(r"[a-z]+:", link[1]):
            continue
        target, _, anchor = link[1].partition("#")
        path = (page.parent / target).resolve() if target else page
        where = f"{page.relative_to(root)}:{line_of(text, link.start())}"
        if not path.exists():
            yield f"{where}: no such file: {target}"
        elif anchor and anchor not in anchors(path.read_text(encoding="utf-8")):
            yield f"{where}: no such heading: {link[1]}"


def missing(root, cited):
    """What of `path: name` isn't there, or nothing."""
    path, colon, name = (part.strip() for part in cited.partition(":"))
    if not (root / path).exists():
        return f"no such file: {path}"
    if not colon:
        return None
    if not (root / path).is_file():
        return f"no file: {path}"
    text = (root / path).read_text(encoding="utf-8")
    suite, dot, test = name.partition(".")
    pattern = (rf"\bT(?:YPED_T)?EST(?:_[FP])?\(\s*{re.escape(suite)}\s*,\s*{re.escape(test)}\s*\)" if dot
               else rf"(?<!\w){re.escape(name)}(?!\w)")
    return None if re.search(pattern, text) else f"{path} has no {name}"


def check(root):
    """(errors, what was looked up)"""
    errors, count = [], 0
    for page in pages(root):
        errors += bad_links(root, page)
    page = root / "docs" / "paper.md"
    text = page.read_text(encoding="utf-8") if page.exists() else ""
    for cited in CITED.finditer(text):
        count += 1
        fault = missing(root, cited[1])
        if fault:
            errors.append(f"docs/paper.md:{line_of(text, cited.start())}: {fault}")
    return errors, count


def main():
    errors, count = check(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve())
    if errors or not count:
        sys.exit("\n".join(errors) or "docs/paper.md names no file")
    print(f"all links, and {count} files and names of docs/paper.md, are there")


if __name__ == "__main__":
    main()
