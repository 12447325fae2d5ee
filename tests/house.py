#!/usr/bin/env python3
"""Counts files, lines and functions of the product sources, and draws or checks the picture of the source folders.
Standard library only."""
import argparse
import re
import sys
import tempfile
from pathlib import Path

LAYERS = ["common", "microsim", "calibrate", "macrosim", "pipelines"]
SHORT = 40  # lines of a file
LONG = 60  # lines of a function
PAGE = 15  # lines of a README of a folder
# The edge, where words come from texts and go to them.
EDGE = re.compile(r"/(scene\w*|kinds/\w+/report\w*|program|law_file|multi_contact_law_io|law_card_read|card_text|run_data|section\w*|xdmf|run_files|text\w*)\.(cpp|h)$|/lammps\w*/")
COMPARED = re.compile(r'[=!]=\s*"[^"]*"|"[^"]*"\s*[=!]=')


def sources(root, layers=LAYERS):
    return [p for layer in layers for p in sorted((root / layer).rglob("*")) if p.suffix in (".h", ".cpp")]


def lines_of(path):
    return path.read_text().splitlines()


NO_FUNCTION = re.compile(r"(namespace|struct|class|union|enum|extern|using|concept)\b")
CLASS = re.compile(r"(struct|class|union)\b")


def functions(lines):
    """First line (from 1) and number of lines of every function: of namespaces, and of classes that are in no other. As
    clang-format lays them out, a function begins at its indentation and ends there with a brace alone."""
    begin, outer, member = 0, "", None
    for k, line in enumerate(lines):
        if re.match(r"[A-Za-z_[]", line):
            begin, outer, member = k, line, None
        elif re.match(r"  [A-Za-z_~[]", line):
            member = k
        if line == "}" and not NO_FUNCTION.match(outer):
            yield begin + 1, k - begin + 1
        elif line == "  }" and CLASS.match(outer) and member is not None and not NO_FUNCTION.match(lines[member][2:]):
            yield member + 1, k - member + 1
            member = None


def rows(root):
    files = sources(root)
    yield "product C++ [lines]", sum(len(lines_of(p)) for p in files)
    yield "product C++ [files]", len(files)
    for layer in LAYERS:
        of = sources(root, [layer])
        yield f"{layer} [files, lines]", f"{len(of)}, {sum(len(lines_of(p)) for p in of)}"
    yield "C++ flat in pipelines/, main.cpp left out", len(flat(root))
    yield f"files under {SHORT} lines", sum(len(lines_of(p)) < SHORT for p in files)
    lengths = [n for p in files for _, n in functions(lines_of(p))]
    yield f"functions of several lines; above {LONG} lines", f"{len(lengths)}, {sum(n > LONG for n in lengths)}"
    yield "comparisons with string literals outside readers", sum(
        len(COMPARED.findall(line.split("//")[0]))
        for p in files if not EDGE.search(str(p)) for line in lines_of(p))
    yield "folders of sources without README.md", len(without_page(root))


def flat(root):
    return [p.name for p in (root / "pipelines").iterdir() if p.suffix in (".h", ".cpp") and p.name != "main.cpp"]


def without_page(root):
    folders = {p.parent for p in sources(root)}
    return sorted(str(f.relative_to(root)) for f in folders if not (f / "README.md").exists() and "fmt_shim" not in f.parts)


WIDTH, HEIGHT, GAP = 1000, 112, 16  # of the picture, a layer, between layers
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
    label = upright if width > 8 * len(text) else along if width > 12 else ""
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


BOX = re.compile(r'font-weight="bold">(\w+)/  (\d+) lines<|<title>([^<]*): (\d+) lines</title>')
SHARE, FEW = 0.1, 20  # of the lines; lines that a picture of this width cannot show


def boxes(svg):
    """Lines by layer and folder, as a picture says them; the folder "" is the whole layer."""
    lines, layer = {}, ""
    for whole, of_layer, folder, of_folder in BOX.findall(svg):
        layer = whole or layer
        lines[layer, folder] = int(of_layer or of_folder)
    return lines


def outdated(root, svg):
    """What a picture shows otherwise than one that is drawn now."""
    shown, now = boxes(svg), boxes(picture(root))
    for layer, folder in sorted(shown.keys() | now.keys()):
        name = f"{layer}/{folder}"
        old, new = shown.get((layer, folder)), now.get((layer, folder))
        if old is None:
            yield f"{name} is not in the picture"
        elif new is None:
            yield f"{name} is in the picture, but not in the tree"
        elif abs(old - new) > max(SHARE * new, FEW):
            yield f"{name} has {new} lines, {old} in the picture"


def compare_picture(root, path):
    problems = list(outdated(root, path.read_text())) if path.exists() else [f"{path} is not there"]
    print("\n".join(problems) if problems else f"{path}: shows the folders of the tree")
    if problems:
        print(f"draw it again: python3 tests/house.py --picture {path}")
    return 1 if problems else 0


FUNCTIONS = """\
namespace a {
struct S {
  int get() const {
    if (b) {
      c();
    }
    return 1;
  }
  [[nodiscard]] int more() const {
    return 2;
  }
};
template <class T>
int f(T x,
      int y) {
  for (;;) {
  }
}
}  // namespace a
"""


def self_test():
    assert list(functions(FUNCTIONS.splitlines())) == [(3, 6), (9, 3), (14, 5)], list(functions(FUNCTIONS.splitlines()))
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)

        def write(name, lines):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text("int x;\n" * lines)

        for layer in LAYERS:
            write(f"{layer}/in/a.cpp", 400)
        write("pipelines/kinds/one/a.cpp", 300)
        write("common/system.h", 200)
        svg = picture(root)
        assert list(outdated(root, svg)) == []
        assert boxes(svg)["pipelines", "kinds/one"] == 300 and boxes(svg)["common", ""] == 600, boxes(svg)
        write("microsim/in/a.cpp", 440)  # 10 % more
        write("pipelines/kinds/one/a.cpp", 280)
        assert list(outdated(root, svg)) == []
        write("microsim/in/a.cpp", 500)
        assert list(outdated(root, svg)) == ["microsim/ has 500 lines, 400 in the picture",
                                             "microsim/in has 500 lines, 400 in the picture"]
        write("microsim/in/a.cpp", 400)
        write("calibrate/new/a.cpp", 10)
        (root / "pipelines/kinds/one/a.cpp").rename(root / "pipelines/kinds/a.cpp")
        assert list(outdated(root, svg)) == ["calibrate/new is not in the picture", "pipelines/kinds is not in the picture",
                                             "pipelines/kinds/one is in the picture, but not in the tree"]
        assert "pipelines/in: has no README.md" in broken(root)
    return 0


def arguments():
    parser = argparse.ArgumentParser(
        description="Counts files, lines and functions of the product sources (" + ", ".join(LAYERS) + ") and prints a "
        "table. Below the table it prints the rules that are broken: a source directly in pipelines/, a folder of sources "
        f"without README.md, a README.md of such a folder with more than {PAGE} lines.")
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parents[1],
                        help="root of the repository; default: the repository of this script")
    parser.add_argument("--hold", action="store_true", help="end with status 1 if a rule is broken")
    parser.add_argument("--picture", type=Path, metavar="FILE.svg",
                        help="draw the folders, each as wide as its number of lines; no table")
    parser.add_argument("--compare", type=Path, metavar="FILE.svg", help="end with status 1 if that picture no longer shows "
                        f"the folders that exist, or their lines to {SHARE:.0%}% (or {FEW} lines); no table")
    parser.add_argument("--self-test", action="store_true", help="check this script on small made-up trees")
    return parser.parse_args()


def main():
    options = arguments()
    if options.self_test:
        return self_test()
    if options.picture:
        options.picture.write_text(picture(options.root))
        return 0
    if options.compare:
        return compare_picture(options.root, options.compare)
    print("| what | count |\n|---|---|")
    for what, count in rows(options.root):
        print(f"| {what} | {count} |")
    problems = list(broken(options.root))
    print("\n".join(problems))
    return 1 if options.hold and problems else 0


if __name__ == "__main__":
    sys.exit(main())
