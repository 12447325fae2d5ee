#!/usr/bin/env python3
"""Counts the house: files, lines, knots and words, as a table. Standard library only.

  house.py ROOT           prints the table
  house.py ROOT --hold    and ends with status 1 where a rule of the house is broken (a kind outside its folder, a folder of
                          sources without its page, a page that is too long)
"""
import re
import sys
from pathlib import Path

LAYERS = ["common", "microsim", "calibrate", "macrosim", "pipelines"]
SHORT = 40  # lines
PAGE = 15  # lines of a README of a folder
# The edge, where words come from texts and go to them.
EDGE = re.compile(r"/(scene\w*|program|law_file|crowd_law_io|law_card_read|card_text|run_data|section\w*|xdmf|run_files|text\w*)\.(cpp|h)$|/lammps\w*/")
COMPARED = re.compile(r'[=!]=\s*"[^"]*"|"[^"]*"\s*[=!]=')


def sources(root, layers=LAYERS):
    return [p for layer in layers for p in sorted((root / layer).rglob("*")) if p.suffix in (".h", ".cpp")]


def lines_of(path):
    return path.read_text().splitlines()


def rows(root):
    files = sources(root)
    yield "product C++ [lines]", sum(len(lines_of(p)) for p in files)
    yield "product C++ [files]", len(files)
    for layer in LAYERS:
        of = sources(root, [layer])
        yield f"{layer} [files, lines]", f"{len(of)}, {sum(len(lines_of(p)) for p in of)}"
    yield "C++ flat in pipelines/, main.cpp left out", len(flat(root))
    yield f"files under {SHORT} lines", sum(len(lines_of(p)) < SHORT for p in files)
    yield "comparisons with string literals outside readers", sum(
        len(COMPARED.findall(line.split("//")[0]))
        for p in files if not EDGE.search(str(p)) for line in lines_of(p))
    yield "folders of sources without README.md", len(without_page(root))


def flat(root):
    return [p.name for p in (root / "pipelines").iterdir() if p.suffix in (".h", ".cpp") and p.name != "main.cpp"]


def without_page(root):
    folders = {p.parent for p in sources(root)}
    return sorted(str(f.relative_to(root)) for f in folders if not (f / "README.md").exists() and "fmt_shim" not in f.parts)


def broken(root):
    for name in flat(root):
        yield f"pipelines/{name}: belongs into a folder"
    for folder in without_page(root):
        yield f"{folder}: has no README.md"
    for folder in {p.parent for p in sources(root)}:
        page = folder / "README.md"
        if page.exists() and len(lines_of(page)) > PAGE:
            yield f"{page.relative_to(root)}: more than {PAGE} lines"


def main():
    root = Path(sys.argv[1])
    print("| what | count |\n|---|---|")
    for what, count in rows(root):
        print(f"| {what} | {count} |")
    problems = list(broken(root))
    print("\n".join(problems))
    return 1 if "--hold" in sys.argv[2:] and problems else 0


if __name__ == "__main__":
    sys.exit(main())
