#!/usr/bin/env python3
"""Writes a new kind of scene from the example in tests/example_kind: its folder, its entry in the table of kinds, its
page, and what the tests of all kinds take of it. The result builds and passes all tests; then change it file by file.
Standard library only.

    python3 tests/new_kind.py my-kind
    cmake --build build/release
    python3 tests/guide_keys.py . build/release/softgrain --write
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

KINDS = "pipelines/kinds"
TINY = """kind = "NAME"
[grain]
radius = "5 mm"
E = "70 GPa"
[impacts]
speeds = [0.1, 1.0]
"""
MISTAKEN = """kind = "NAME"
[grain]
raduis = 1
E = -1
[impacts]
speeds = []
"""
MESSAGE = """s:2: missing key 'radius' in [grain]; did 'raduis' at s:3 mean it?
s:4: E = -1: must be above 0
s:6: speeds = []: at least one is needed"""
PAGE = """# Scenes of kind "NAME"

This page describes scenes of kind `"NAME"`: impacts of an elastic grain on a rigid plane.

<!-- keys: NAME . -->
<!-- /keys -->

## The grain

<!-- keys: NAME grain -->
<!-- /keys -->

## Impacts

<!-- keys: NAME impacts -->
<!-- /keys -->
"""


def words(name):
    """The name as it stands in files and functions, and in types: my_kind, MyKind."""
    return name.replace("-", "_"), "".join(part.capitalize() for part in name.split("-"))


def renamed(text, name):
    """The text of a file of the example, with the new name."""
    snake, camel = words(name)
    text = text.replace("tests/example_kind/", f"{KINDS}/{snake}/")
    text = text.split(" It shows all that a kind of scene has;")[0].rstrip() + "\n"  # README.md
    text = re.sub(r"softgrain example impact", f"softgrain {name} impact", text)
    text = re.sub(r'"example', f'"{name}', text)
    text = text.replace("Example", camel)
    return re.sub(r"(?<![A-Za-z])example(?=[_)])|(?<=_)example(?![A-Za-z])", snake, text)


def insert(path, before, text):
    """Puts a text before another one that stands in the file once."""
    content = path.read_text()
    if content.count(before) != 1:
        raise SystemExit(f"new_kind.py: {path}: '{before.strip()}' is not there once: insert by hand:\n{text}")
    path.write_text(content.replace(before, text + before))


def write_kind(root, name):
    """All files of the kind, and all entries in files that list kinds."""
    snake, camel = words(name)
    folder = root / KINDS / snake
    if folder.exists():
        raise SystemExit(f"new_kind.py: {folder} exists")
    folder.mkdir(parents=True)
    for source in sorted((root / "tests/example_kind").iterdir()):
        (folder / source.name).write_text(renamed(source.read_text(), name))
    include = f'#include "{KINDS}/{snake}/scene.h"\n'
    table = root / KINDS / "kinds.cpp"
    insert(table, f'#include "{KINDS}/pipeline/scene.h"\n', include)
    insert(table, "recipe_kind()};", f"{snake}_kind(), ")
    what = root / "tests/support/what_is_run.h"
    insert(what, f'#include "{KINDS}/pipeline/scene.h"\n', include)
    insert(what, "  else\n    ADD_FAILURE()", f'  else if (kind == "{name}")\n    f(read_{snake}(scene));\n')
    every = root / "tests/support/every_kind.h"
    insert(every, "struct KindScene {", f'inline constexpr const char* kTiny{camel} = R"({TINY.replace("NAME", name)})";\n\n')
    insert(every, "                               {\"grain-box\", \"\", kTinyGrainBox, 0}};",
           f'                               {{"{name}", "", kTiny{camel}, 0, true}},\n')
    insert(root / "tests/unit/test_kinds.cpp", "}};\n\nTEST(Kinds, SayAllMistakesOfASceneAtOnce)",
           f'}},\n    {{R"({MISTAKEN.replace("NAME", name)})",\n     R"({MESSAGE})"')
    guide = root / "pipelines/guide"
    (guide / f"scene_{snake}.md").write_text(PAGE.replace("NAME", name))
    insert(guide / "scenes.md", '| `"grain-box"` |', f'| `"{name}"` | [scenes of this kind](scene_{snake}.md) |\n')
    insert(guide / "choosing.md", "| How does a result depend on a key,",
           f"| How long does an impact last? | `{name}` | `run my_scene.toml` | [scenes of this kind](scene_{snake}.md) |\n")
    insert(guide / "README.md", "[single particles and walls](scene_particles.md), [a cohesive powder]",
           f"[scenes of kind `{name}`](scene_{snake}.md), ")
    sources = sorted(str(path) for path in folder.iterdir() if path.suffix in (".h", ".cpp"))
    sources += [str(path) for path in (table, what, every)]
    try:
        subprocess.run(["clang-format-14", "-i", *sources], check=True)
    except FileNotFoundError:
        print("new_kind.py: clang-format-14 is not installed: format the new files by hand", file=sys.stderr)
    subprocess.run([sys.executable, str(root / "tests/house.py"), str(root), "--picture", str(guide / "house.svg")], check=True)


def self_test(root):
    """A copy of the repository with a kind more passes the checks of sources and pages."""
    with tempfile.TemporaryDirectory() as temporary:
        copy = pathlib.Path(temporary) / "copy"
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns("build", ".git", "*.h5", "__pycache__"))
        write_kind(copy, "self-test")
        left = [str(path) for path in (copy / KINDS / "self_test").iterdir()
                if re.search(r"(?i)example", path.read_text())]
        assert not left, f"these still name the example: {left}"
        entry = (copy / KINDS / "kinds.cpp").read_text()
        assert "self_test_kind()" in entry and f'#include "{KINDS}/self_test/scene.h"' in entry
        for check in (["check_layers.py", "."], ["check_names.py", "."], ["check_guide.py", "."], ["house.py", ".", "--hold"],
                      ["house.py", ".", "--compare", "pipelines/guide/house.svg"]):
            subprocess.run([sys.executable, "tests/" + check[0], *check[1:]], cwd=copy, check=True, stdout=subprocess.DEVNULL)
        try:
            write_kind(copy, "self-test")
        except SystemExit as refusal:
            assert "exists" in str(refusal)
        else:
            raise AssertionError("a kind that is there was written again")
    print("new_kind.py: self-test passed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="?", help="value of the key `kind`: lower-case letters, with `-` between words")
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent, type=pathlib.Path,
                        help="root of the repository; default: the repository of this script")
    parser.add_argument("--self-test", action="store_true", help="try it on a copy of the repository")
    arguments = parser.parse_args()
    if arguments.self_test:
        return self_test(arguments.root)
    if arguments.name is None:
        parser.error("the name of the kind is missing")
    if not re.fullmatch(r"[a-z]+(-[a-z]+)*", arguments.name):
        parser.error(f"'{arguments.name}': must be lower-case letters, with '-' between words")
    write_kind(arguments.root, arguments.name)
    print(f"""{KINDS}/{words(arguments.name)[0]}: written. Next:
  cmake --build build/release
  python3 tests/guide_keys.py . build/release/softgrain --write
  ./softgrain test
Then change scene, run and report file by file; the tests say what is missing.""")


if __name__ == "__main__":
    main()
