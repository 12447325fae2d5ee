#!/usr/bin/env python3
"""Counts the house: files, lines, knots and words, as a table. Standard library only.

  house.py ROOT           prints the table
  house.py ROOT --picture FILE.svg   draws the folders, as wide as their lines are many
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
EDGE = re.compile(r"/(scene\w*|program|law_file|multi_contact_law_io|law_card_read|card_text|run_data|section\w*|xdmf|run_files|text\w*)\.(cpp|h)$|/lammps\w*/")
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


WIDTH, HEIGHT, GAP = 1000, 96, 16  # of the picture, a layer, between layers
COLOURS = {"pipelines": "#d9e7f5", "microsim": "#e2f0d9", "calibrate": "#fdf0cf", "macrosim": "#f8dfd3", "common": "#e6e1f0"}


def lines_by_folder(root, layer):
    lines = {}
    for p in sources(root, [layer]):
        inside = p.relative_to(root / layer).parts[:-1]
        name = "/".join(inside[:2] if inside[:1] == ("kinds",) else inside[:1])
        lines[name] = lines.get(name, 0) + len(lines_of(p))
    return sorted(lines.items(), key=lambda item: -item[1])


def box(x, y, width, height, colour, name, lines):
    title = f"{name or 'beside folders'}: {lines} lines"
    text = name.split("/")[-1]
    upright = f'<text x="{x + 4:.1f}" y="{y + 16}">{text}</text>'
    along = f'<text transform="translate({x + width / 2 + 4:.1f} {y + height - 4}) rotate(-90)">{text}</text>'
    label = upright if width > 7 * len(text) else along if width > 12 else ""
    return (f'<g><title>{title}</title><rect x="{x:.1f}" y="{y}" width="{width:.1f}" height="{height}" fill="{colour}" '
            f'stroke="#fff" stroke-width="2"/>{label}</g>')


def layer_row(root, layer, x, y, width):
    """A layer: its folders side by side, each as wide as it has lines."""
    folders = lines_by_folder(root, layer)
    scale = width / sum(n for _, n in folders)
    for name, n in folders:
        yield box(x, y, n * scale, HEIGHT, COLOURS[layer], name, n)
        x += n * scale


def picture(root):
    """Who stands above may include who stands below; neighbours in a row do not know of each other."""
    parts = []
    for k, row in enumerate([["pipelines"], ["microsim", "calibrate", "macrosim"], ["common"]]):
        y = 24 + k * (HEIGHT + GAP + 18)
        of = {layer: sum(n for _, n in lines_by_folder(root, layer)) for layer in row}
        x, room = 0.0, WIDTH - GAP * (len(row) - 1)
        for layer in row:
            width = room * of[layer] / sum(of.values())
            parts.append(f'<text x="{x:.1f}" y="{y - 6}" font-weight="bold">{layer}/  {of[layer]} lines</text>')
            parts += layer_row(root, layer, x, y, width)
            x += width + GAP
    height = 24 + 3 * (HEIGHT + GAP + 18) - GAP
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" font-size="11">'
            + "\n".join(parts) + "</svg>\n")


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
    if "--picture" in sys.argv[2:]:
        Path(sys.argv[3]).write_text(picture(root))
        return 0
    print("| what | count |\n|---|---|")
    for what, count in rows(root):
        print(f"| {what} | {count} |")
    problems = list(broken(root))
    print("\n".join(problems))
    return 1 if "--hold" in sys.argv[2:] and problems else 0


if __name__ == "__main__":
    sys.exit(main())
