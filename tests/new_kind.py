#!/usr/bin/env python3
"""Writes a new kind of scene from the example in tests/example_kind: its folder, its entry in the table of kinds, its
page, and what the tests of all kinds take of it. The result builds and passes all tests; then change it file by file.
Standard library only.

    python3 tests/new_kind.py my-kind
    cmake --build build/release
    python3 tests/guide_keys.py . build/release/softgrain --write
"""
import re
import subprocess
import sys

from new_files import Changes, parsed, self_test, words

KINDS = "pipelines/kinds"
GUIDE = "pipelines/guide"
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


def renamed(text, name):
    """The text of a file of the example, with the new name."""
    snake, camel = words(name)
    text = text.replace("tests/example_kind/", f"{KINDS}/{snake}/")
    text = text.split(" It shows all that a kind of scene has;")[0].rstrip() + "\n"  # README.md
    text = re.sub(r"softgrain example impact", f"softgrain {name} impact", text)
    text = re.sub(r'"example', f'"{name}', text)
    text = text.replace("Example", camel)
    return re.sub(r"(?<![A-Za-z])example(?=[_)])|(?<=_)example(?![A-Za-z])", snake, text)


def write_kind(root, name):
    """All files of the kind, and all entries in files that list kinds; all of them, or a refusal."""
    snake, camel = words(name)
    folder = f"{KINDS}/{snake}"
    changes = Changes("new_kind.py", root)
    if (root / folder).exists():
        raise SystemExit(f"new_kind.py: {root / folder} exists")
    for source in sorted((root / "tests/example_kind").iterdir()):
        changes.create(f"{folder}/{source.name}", renamed(source.read_text(), name))
    include = f'#include "{folder}/scene.h"\n'
    table, what, every = f"{KINDS}/kinds.cpp", "tests/support/what_is_run.h", "tests/support/every_kind.h"
    changes.before(table, f'#include "{KINDS}/pipeline/scene.h"\n', include)
    changes.before(table, "recipe_kind()};", f"{snake}_kind(), ")
    changes.before(what, f'#include "{KINDS}/pipeline/scene.h"\n', include)
    changes.before(what, "  else\n    ADD_FAILURE()", f'  else if (kind == "{name}")\n    f(read_{snake}(scene));\n')
    changes.before(every, "struct KindScene {",
                   f'inline constexpr const char* kTiny{camel} = R"({TINY.replace("NAME", name)})";\n\n')
    changes.before(every, "                               {\"grain-box\", \"\", kTinyGrainBox, 0}};",
                   f'                               {{"{name}", "", kTiny{camel}, 0, true}},\n')
    changes.before("tests/unit/test_kinds.cpp", "}};\n\nTEST(Kinds, SayAllMistakesOfASceneAtOnce)",
                   f'}},\n    {{R"({MISTAKEN.replace("NAME", name)})",\n     R"({MESSAGE})"')
    changes.create(f"{GUIDE}/scene_{snake}.md", PAGE.replace("NAME", name))
    changes.before(f"{GUIDE}/scenes.md", '| `"grain-box"` |', f'| `"{name}"` | [scenes of this kind](scene_{snake}.md) |\n')
    changes.before(f"{GUIDE}/choosing.md", "| How does a result depend on a key,",
                   f"| How long does an impact last? | `{name}` | `run my_scene.toml` | [scenes of this kind](scene_{snake}.md) |\n")
    changes.before(f"{GUIDE}/README.md", "[single particles and walls](scene_particles.md), [a cohesive powder]",
                   f"[scenes of kind `{name}`](scene_{snake}.md), ")
    changes.write()
    subprocess.run([sys.executable, str(root / "tests/house.py"), str(root), "--picture", str(root / GUIDE / "house.svg")],
                   check=True)


def look(copy, _):
    """The kind and its entries in a copy of the repository."""
    left = [str(path) for path in (copy / KINDS / "self_test").iterdir() if re.search(r"(?i)example", path.read_text())]
    assert not left, f"these still name the example: {left}"
    entry = (copy / KINDS / "kinds.cpp").read_text()
    assert ".summary = members_of<SelfTestSummary>" in (copy / KINDS / "self_test/run.cpp").read_text(), "the test Kinds asks for it"
    assert "self_test_kind()" in entry and f'#include "{KINDS}/self_test/scene.h"' in entry
    subprocess.run([sys.executable, "tests/house.py", ".", "--compare", f"{GUIDE}/house.svg"], cwd=copy, check=True,
                   stdout=subprocess.DEVNULL)


def main():
    arguments = parsed(__doc__, "kind")
    if arguments.self_test:
        return self_test("new_kind.py", arguments.root, write_kind,
                         (f"{GUIDE}/README.md", "[single particles and walls](scene_particles.md), "), look)
    write_kind(arguments.root, arguments.name)
    print(f"""{KINDS}/{words(arguments.name)[0]}: written. Next:
  cmake --build build/release
  python3 tests/guide_keys.py . build/release/softgrain --write
  ./softgrain test
Then change scene, run and report file by file; the tests say what is missing.""")


if __name__ == "__main__":
    main()
