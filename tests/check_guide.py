#!/usr/bin/env python3
"""Holds the guide to the sources: every key that a reader of scenes asks for stands in a table of the page of its kind, every
key in those tables is asked for by a reader, every link and picture is there, and every source that the pages for developers
name. Results that are kept are small, or named as large.

Keys are found in the sources by the calls that read them (t.number("key", ...), read_range(t, "key", ...)); which page a
source belongs to is written down below, and a source that reads scenes and is in no list is an error.

    check_guide.py ROOT | --self-test
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

GUIDE = "pipelines/guide"

# Page: its sources, keys that go through a variable there, and words that look like keys of scenes and are none.
PAGES = {
    "scene_pipeline.md": (
        ["common/data/soft_particle_schema.cpp", "pipelines/kinds/soft_particle/scene.cpp", "pipelines/kinds/pipeline/scene.cpp", "pipelines/kinds/macro/scene.cpp",
         "pipelines/kinds/law_table/multi_contact_law_fit.cpp",
         "pipelines/kinds/macro_comparison/scene.cpp", "pipelines/law/named_laws.cpp",
         "pipelines/commands/calibrate.cpp", "pipelines/law/fit_settings.cpp",
         "pipelines/kinds/soft_particle/snapshot_recorder.cpp"],
        {"beyond", "modulus_stress"}, {"cell", "entry", "pair", "macrosim"}),
    "scene_material_models.md": (["pipelines/kinds/material_models/scene.cpp"], {"name"}, set()),
    "scene_law_table.md": (
        ["pipelines/kinds/law_table/scene.cpp", "pipelines/kinds/law_table/multi_contact_scene.cpp", "pipelines/kinds/law_table/multi_contact_law_fit.cpp",
         "pipelines/kinds/hierarchy/scene.cpp"],
        {"material", "packing"}, set()),
    "scene_particles.md": (
        ["microsim/particles/guards.cpp", "microsim/particles/particles_scene.cpp", "microsim/particles/scene_bodies.cpp",
         "microsim/particles/scene_contacts.cpp", "microsim/particles/scene_drawn.cpp",
         "microsim/particles/scene_soft_laws.cpp", "microsim/particles/scene_time.cpp", "microsim/particles/scene_walls.cpp"],
        {"beyond"}, {"energy_unwatched", "entry"}),
    "scene_powder.md": (
        ["pipelines/kinds/cohesive_powder/scene.cpp", "pipelines/kinds/cohesive_powder/variants.cpp", "pipelines/run/scene_kind.h"],
        {"Phi", "z", "Phi_error", "z_error"}, set()),
    "own_data.md": (["pipelines/commands/calibrate_curves.cpp", "pipelines/law/fit_settings.cpp", "pipelines/kinds/inverse/scene.cpp"],
                    {"beta", "trials", "mu", "nu", "rmax_over_shell", "exponent", "polydispersity", "material"},
                    {"kind", "title", "measure", "rmax"}),
    "scene_material.md": (
        ["pipelines/kinds/material/scene.cpp", "pipelines/kinds/material/equation.cpp", "pipelines/run/scene_kind.h"],
        {"preparation", "start_pressure", "preparation_tolerance", "strain", "steps", "increments_per_step", "preload", "preload_steps",
                "tolerance", "force_floor", "max_passes", "modulus_stress", "snapshots", "stage", "test", "output"}, {"solid_fraction", "rattlers"}),
    "scene_material_law.md": (
        ["pipelines/kinds/material_law/scene.cpp"],
        {"preload", "preload_steps", "strain", "steps", "increments_per_step", "tolerance", "force_floor", "max_passes", "modulus_stress", "material", "grains",
                "packing", "output", "snapshots", "count", "test"}, set()),
    "scene_recipe.md": (
        ["pipelines/kinds/recipe/scene.cpp"],
        {"material", "packing", "test", "output", "snapshots", "exponent", "radius_max", "count"}, set()),
    "stages.md": (["pipelines/kinds/macro/stages.cpp"], {"strain_x", "strain_y", "strain_z", "stress_x", "stress_y", "stress_z"}, {"stage", "macro", "test"}),
    "sizes.md": (["common/packing/grading_scene.cpp"], set(), {"solid_sizes", "soft_sizes", "disks", "material", "packing", "macro"}),
    "scene_grain_box.md": (["pipelines/kinds/grain_box/scene.cpp", "pipelines/run/scene_kind.h"], set(), set()),
}

# Sources that read cards and tables, or a scene only to see what it is.
NO_SCENES = {
    "pipelines/run/run_context.cpp",
    "pipelines/kinds/law_table/law_check.cpp",
    "common/data/card_text.cpp", "pipelines/law/law_file.cpp", "pipelines/law/law_file_kind.cpp", "common/data/cell_card_io.cpp", "common/data/multi_contact_law_io.cpp", "common/data/law_card_read.cpp",
    "pipelines/commands/check.cpp", "pipelines/kinds/kinds.cpp", "pipelines/kinds/macro/run.cpp", "pipelines/kinds/pipeline/run.cpp",
    "pipelines/commands/calibrate_multi_contact.cpp", "pipelines/commands/observables.cpp", "pipelines/kinds/cohesive_powder/run.cpp",
    "pipelines/kinds/cohesive_powder/variants_run.cpp", "pipelines/runs/run_set.cpp",
}

READERS = "has|is_text|is_list|number|count|flag|text|choice|vector3|numbers|texts|flags|table|table_or_empty|tables|named"
CALL = re.compile(r'(?:\.|->)\s*(?:%s)(?:<\w+>)?\(\s*"([A-Za-z_]\w*)"' % READERS)
# A table and a key handed to a helper: read_friction(t, "wall_mu", ...).
HANDED = re.compile(r'\b(?:t|root|table|scene|macro|law|walls|material|loading|escape)\s*,\s*"([A-Za-z_]\w*)"')
# The key in scenes of a number that is described once: {"friction", "mu", &S::friction, ...}.
DESCRIBED = re.compile(r'\{"\w+", "(\w+)", &S::')
KEY = re.compile(r"`\[{0,2}([A-Za-z_][\w.]*)\]{0,2}`")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def keys_read(path):
    text = path.read_text()
    return set(CALL.findall(text)) | set(HANDED.findall(text)) | set(DESCRIBED.findall(text))


def reads_scenes(path):
    return re.search(r"\bSceneTable\b|\bScene(?:::|&)", path.read_text()) is not None and keys_read(path)


def rows(page):
    """Rows of the tables whose first column is called `key`, without their heads."""
    inside = False
    for line in page.read_text().splitlines():
        if not line.startswith("|"):
            inside = False
            continue
        cells = [c.strip() for c in line.strip("|").split("|")]
        if cells[0] == "key":
            inside = True
        elif inside and not set(line) <= set("|-: "):
            yield cells


def words(cell):
    """Keys in backquotes: `key`, `[table]`, `[[tables]]`, `[table.below]`; NAME stands for any word."""
    found = set()
    for word in KEY.findall(cell):
        found |= {part for part in word.split(".") if part != "NAME"}
    return found


def check_page(root, name, sources, extra, no_keys=frozenset()):
    page = root / GUIDE / name
    read = set(extra)
    for source in sources:
        read |= keys_read(root / source) - no_keys
    first, anywhere = set(), set()
    for cells in rows(page):
        first |= words(cells[0])
        anywhere |= set().union(*map(words, cells))
    problems = [f"{name}: key '{k}' of the sources is in no table of the page" for k in sorted(read - anywhere)]
    return problems + [f"{name}: no reader asks for key '{k}'" for k in sorted(first - read)]


def check_sources(root):
    known = NO_SCENES | {s for sources, *_ in PAGES.values() for s in sources}
    problems = []
    for folder in ("common/data", "common/contact", "microsim", "macrosim", "calibrate", "pipelines"):
        for path in sorted((root / folder).rglob("*.cpp")):
            name = path.relative_to(root).as_posix()
            if name not in known and reads_scenes(path):
                problems.append(f"{name} reads scenes: give it a page in tests/check_guide.py, and its keys "
                                f"({', '.join(sorted(keys_read(path)))}) a place there")
    return problems


def check_links(root):
    problems = []
    for page in [root / "README.md", *sorted((root / GUIDE).glob("*.md"))]:
        for target in LINK.findall(page.read_text()):
            if not re.match(r"[a-z]+:|#", target) and not (page.parent / target.split("#")[0]).exists():
                problems.append(f"{page.relative_to(root)}: {target} is not there")
    return problems


# Pages that name files of the tree, and from where they name them.
DEVELOPERS = ("developing.md", "decisions.md", "style.md")
FOLDERS = ("", "pipelines")
PATH = re.compile(r"`([\w.-]+(?:/[\w.-]+)+)`")


def check_paths(root):
    problems = []
    for page in (root / GUIDE / name for name in DEVELOPERS):
        for path in PATH.findall(page.read_text()) if page.exists() else []:
            there = [root / folder / (path + ending) for folder in FOLDERS for ending in ("", ".h")]
            if "NAME" not in path and not any(p.exists() for p in there):
                problems.append(f"{page.relative_to(root)}: `{path}` is not in the tree")
    return problems


LARGEST_RESULT = 200_000  # bytes


def check_sizes(root, kept=None):
    """Files under results/ that the repository keeps; without git there is no telling them from runs."""
    if kept is None:
        listed = subprocess.run(["git", "-C", str(root), "ls-files", "results"], capture_output=True, text=True)
        kept = listed.stdout.split() if listed.returncode == 0 else []
    page = root / "results/README.md"
    named = page.read_text() if page.exists() else ""
    return [f"{name} has {(root / name).stat().st_size} bytes, more than {LARGEST_RESULT}: make it smaller, or name it in "
            "results/README.md" for name in kept
            if (root / name).exists() and (root / name).stat().st_size > LARGEST_RESULT and name.removeprefix("results/") not in named]


def check(root):
    problems = check_sources(root) + check_links(root) + check_paths(root) + check_sizes(root)
    for name, page in PAGES.items():
        problems += check_page(root, name, *page)
    return problems


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / GUIDE).mkdir(parents=True)
        (root / "a.cpp").write_text('t.number("radius", x); t.table_or_empty(\n "box"); read_range(t, "low", 1);')
        page = root / GUIDE / "p.md"
        table = "| key | meaning |\n|---|---|\n| `[box]` `radius` | from `low`, `\"word\"` |\n"
        page.write_text(table)
        assert check_page(root, "p.md", ["a.cpp"], set()) == [], check_page(root, "p.md", ["a.cpp"], set())
        page.write_text(table.replace("`low`", "low"))
        assert "'low'" in check_page(root, "p.md", ["a.cpp"], set())[0]
        page.write_text(table + "| `colour` | none |\n")
        assert "no reader asks for key 'colour'" in check_page(root, "p.md", ["a.cpp"], set())[0]
        (root / "results").mkdir()
        (root / "results/small").write_bytes(b"x" * LARGEST_RESULT)
        (root / "results/large").write_bytes(b"x" * (LARGEST_RESULT + 1))
        assert [p.split()[0] for p in check_sizes(root, ["results/small", "results/large"])] == ["results/large"]
        (root / "results/README.md").write_text("one `large` file")
        assert check_sizes(root, ["results/small", "results/large"]) == []
        page.write_text("[x](nowhere.md) [y](p.md#z) [z](https://example.org)")
        (root / "README.md").write_text("")
        assert check_links(root) == [f"{GUIDE}/p.md: nowhere.md is not there"]
        (root / GUIDE / "style.md").write_text("`pipelines/guide/p.md`, `guide/p.md`, `kinds/NAME`, `common/gone.h` and `a.cpp`")
        assert check_paths(root) == [f"{GUIDE}/style.md: `common/gone.h` is not in the tree"], check_paths(root)
        (root / "pipelines/new.cpp").write_text('int f(const SceneTable& t) { return t.flag("new", true); }')
        assert "pipelines/new.cpp reads scenes" in check_sources(root)[0]


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    problems = check(Path(sys.argv[1]))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
