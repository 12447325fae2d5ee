#!/usr/bin/env python3
"""Runs every command block of README.md, tests/README.md and pipelines/guide/*.md, in order, in a copy of the tree made of links.

    run_blocks.py ROOT PROGRAM [--slow] [--compiler CXX --header DIR]    default: seconds; --slow: what takes minutes, as it stands
    run_blocks.py ROOT --list                                            how each command is tested
    run_blocks.py --self-test

A command that RULES do not know fails: say there how it is tested. Blocks: sh (commands), toml (scenes, run by the program),
cpp (compiled against the law header in DIR; a comment `// 0.634 N` behind the last line is what must come out), cmake (those of the
test `install`), python (those of the test `python_examples`).
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# The pipeline in seconds: few coarse grains, few points. Its laws are underdetermined, so that it ends with status 3.
SMALL_PIPELINE = [
    "packing.trials=100", "packing.polydispersity=5", "packing.beta=8", "packing.count=4", "measure.relaxation=damped",
    "measure.damped.increment=0.02", "measure.soft_solid.deltas=[0.1,0.2,0.3,0.35,0.4,0.45]",
    "measure.soft_solid.tangential_deltas=[0.35,0.4,0.45]", "measure.soft_solid.angles_deg=[-0.05,0.05]",
    "measure.soft_soft.deltas=[0.2,0.3,0.4,0.45,0.5,0.55,0.6]", "measure.soft_soft.tangential_deltas=[0.5,0.6]",
    "measure.soft_soft.angles_deg=[-0.05,0.05]", "reference.relaxation=least-work",
    "reference.soft_solid.deltas=[0.4]", "reference.count=1", "measure.least_work.settle_time=8",
    "calibrate.min_packings=2", "calibrate.replicates=20", "macro.bodies=8", "macro.samples=1", "macro.steps=4",
    "macro.strain=0.3", "macro.bands=8", "multi_contact.packings_min=4", "multi_contact.packings_max=4", "multi_contact.increment=0.05", "multi_contact.settle_time=5", "multi_contact.tolerance=0.1",
    "calibrate.multi_contact.replicates=10",
    'configuration=[{arrangement="one",partner="plane",overlap=0.45},{arrangement="cube",partner="plane",overlap=0.3},'
    '{arrangement="one",partner="solid",ratio=1.0,overlap=0.45},{arrangement="one",partner="soft",ratio=1.0,overlap=0.55}]']


class Run:
    """The program itself; quickly with `settings` where it would take long, which `slow` then runs as it stands."""

    def __init__(self, settings=(), slow=False, statuses=(0,)):
        self.settings, self.slow, self.statuses = list(settings), slow, statuses

    def told(self):
        if self.slow:
            return "default suite: with small settings; label slow: as it stands"
        return "default suite: as it stands"

    def quick(self, command):
        return command + "".join(f" --set '{s}'" for s in self.settings)

    def slowly(self, command):
        return command, (0,)


# An hour and half an hour on two cores: minutes with fewer packings, samples and bodies.
SMALL_TABLE = ["multi_contact.packings_min=7", "multi_contact.packings_max=7", "multi_contact.points=4", "calibrate.replicates=20",
               "variant=[]", "plan=[]", "packing.polydispersity=3", "packing.trials=100"]
SMALL_COMPARISON = ["macro.samples=1", "macro.bodies=12", "macro.steps=3"]


class Check:
    """Minutes to hours: `softgrain check` reads the scene and says what it would take; `slow` runs it, with `settings` where
    it would take half an hour or more."""
    statuses = (0,)

    def __init__(self, slow=False, settings=()):
        self.slow, self.settings = slow, list(settings)

    def told(self):
        runs = ("with small settings" if self.settings else "as it stands") if self.slow else "the same"
        return f"default suite: its scene by `softgrain check`; label slow: {runs}"

    def slowly(self, command):
        return command + "".join(f" --set '{s}'" for s in self.settings), (0, 3) if self.settings else (0,)

    @staticmethod
    def quick(command):
        words = command.split()
        return f"{words[0]} check {next(w for w in words[2:] if w.endswith('.toml'))} --quiet"


class OnBlock(Run):
    """The program on my_scene.toml, which is the last scene of the page; with `instead` of what would take long."""

    def __init__(self, instead=()):
        super().__init__()
        self.instead = instead

    def told(self):
        return "default suite: on the scene of the page" + (", smaller" if self.instead else "")

    def quick(self, command):
        for long, short in self.instead:
            command = command.replace(long, short)
        return "cp block.toml my_scene.toml; " + command


class Elsewhere:
    """Tested by something else."""
    slow = False

    def __init__(self, where):
        self.where = where

    def told(self):
        return self.where


PRESETS = "default suite: that the presets are there"
RULES = [
    (r"\./softgrain run pipelines/quickstart\.toml", Run(SMALL_PIPELINE, slow=True, statuses=(0, 3))),
    (r"\./softgrain test( -[LR] \w+)?", Elsewhere("this suite; the start script by the test start_script")),
    (r"ctest --preset [\w-]+|cmake --(build )?--preset [\w-]+|cmake --build --preset [\w-]+|cmake --preset [\w-]+",
     Elsewhere(PRESETS)),
    (r"python3 tests/new_law\.py my-law", Elsewhere("default suite: the test new_law_self_test")),
    (r"python3 tests/new_kind\.py my-kind|cmake --build build/release|python3 tests/guide_keys\.py .*",
     Elsewhere("default suite: the tests new_kind_self_test and guide_keys")),
    (r"cmake --install build/release --prefix /usr/local", Elsewhere("default suite: the test install")),
    (r"\(cd build/package|cpack -G DEB\)|apt-get install \./build/package/(python3-)?softgrain_\*\.deb"
     r"|softgrain run /usr/share/softgrain/pipelines/quickstart\.toml",
     Elsewhere("by hand, in a bare Debian root: pipelines/guide/installing.md")),
    (r"\./softgrain sweep my_scene\.toml --over grains\.count=500.*", OnBlock([("500,1000,2000,4000", "400,500")])),
    (r"\./softgrain (check|run|macrosim|sweep) my_scene\.toml.*|\./softgrain compare results/my_.*", OnBlock()),
    (r"\./softgrain check pipelines/sieve_analysis\.csv", Run()),
    (r"\./softgrain export results/quickstart --to [\w-]+( --out \S+)?", Run()),
    (r"\./softgrain run pipelines/law_table\.toml --out results/my_\w+", Check(slow=True, settings=SMALL_TABLE)),
    (r"\./softgrain run pipelines/macro_vs_resolved\.toml --out results/my_\w+", Check(slow=True, settings=SMALL_COMPARISON)),
    (r"\./softgrain run pipelines/four_decades\.toml", Check()),
    (r"\./softgrain microsim pipelines/powder_\w+\.toml", Check()),
    (r"\./softgrain law (show|eval|export|get) .*|\./softgrain schema .*", Run()),
    (r"\./softgrain calibrate pipelines/press_test\.csv --set mirror=true", Run()),
    (r"\./softgrain run pipelines/press_test_(macro|library)\.toml", Run(("macro.bodies=30", "macro.bands=8"), slow=True)),
    (r"\./softgrain run pipelines/inverse\.toml", Check(slow=True)),
    (r"\./softgrain microsim pipelines/grainlearning_example/soft_particle\.toml .*", Run(statuses=(0, 3))),
    (r"python3 pipelines/grainlearning_example/calibrate\.py", Elsewhere("default suite: the tests OwnData")),
    (r"\./softgrain setup --with-lammps|\./softgrain macrosim scene\.toml --law law\.toml --engine lammps .*"
     r"|mpirun -np 512 softgrain-lammps -in scene\.in( -var from 12)?|cmake --build build/release --target softgrain-lammps",
     Elsewhere("default suite: the tests MacroLammps, with softgrain-lammps WithLammps")),
    (r"\./softgrain run pipelines/material\.toml --engine lammps .*", Elsewhere("default suite: the tests MaterialLammps")),
    (r"\./softgrain microsim pipelines/glass_beads_small\.toml",
     Run()),
]
def blocks(page):
    """(language, first line, text) of every fenced block."""
    fence = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
    text = page.read_text()
    return [(m[1], text[:m.start()].count("\n") + 2, m[2]) for m in fence.finditer(text)]


def commands(text):
    """Commands of a block: comments go, lines that end with a backslash are joined, && separates."""
    for line in text.replace("\\\n", " ").splitlines():
        line = re.sub(r"(^|\s)#.*", "", line)
        yield from (c.strip() for c in line.split("&&") if c.strip())


def rule_of(command):
    for pattern, rule in RULES:
        if re.fullmatch(pattern, " ".join(command.split())):
            return rule
    return None


def pages(root):
    return [root / "README.md", root / "tests/README.md", *sorted((root / "pipelines/guide").glob("*.md"))]


def link_tree(root, work, program):
    """Everything of the tree by links, but results to write into and the program in place of the start script."""
    for entry in root.iterdir():
        if entry.name not in ("build", "results", "softgrain", ".git"):
            (work / entry.name).symlink_to(entry)
    (work / "results").mkdir()
    for entry in (root / "results").iterdir():
        if (entry / "README.md").exists():
            subprocess.run(["cp", "-R", str(entry), str(work / "results")], check=True)  # runs may write there
    script = work / "softgrain"
    script.write_text(f"#!/bin/sh\nexec '{program}' \"$@\"\n")
    script.chmod(0o755)


class Session:
    def __init__(self, root, program, slow, compiler, header):
        self.root, self.slow, self.compiler, self.header = root, slow, compiler, header
        self.folder = tempfile.TemporaryDirectory()
        self.work = Path(self.folder.name)
        link_tree(root, self.work, program)
        self.environment = dict(os.environ, PATH=f"{self.work}:{os.environ['PATH']}")
        self.problems = []

    def execute(self, where, command, statuses):
        run = subprocess.run(["sh", "-c", command], cwd=self.work, env=self.environment, text=True, stdin=subprocess.DEVNULL,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        print(f"{where}: {command[:100]}: status {run.returncode}", flush=True)
        if run.returncode not in statuses:
            self.problems.append(f"{where}: {command}: status {run.returncode}\n{run.stdout[-2000:]}")
        return run.stdout

    def command(self, where, command):
        rule = rule_of(command)
        if rule is None:
            self.problems.append(f"{where}: no rule in tests/run_blocks.py says how to test: {command}")
        elif isinstance(rule, Elsewhere):
            if rule.where == PRESETS:
                self.preset(where, command)
        elif self.slow:
            if rule.slow:
                self.execute(where, *rule.slowly(command))
        else:
            self.execute(where, rule.quick(command), rule.statuses)

    def preset(self, where, command):
        # By hand: python3-minimal has no json.
        text = (self.root / "CMakePresets.json").read_text()
        group = "testPresets" if command.startswith("ctest") else "configurePresets"
        group = text[text.index(f'"{group}": ['):]
        group = group[:re.search(r"\n  \]|\]\}?$", group).start()]
        name = command.split()[-1]
        if f'"name": "{name}"' not in group:
            self.problems.append(f"{where}: {command}: no preset {name}")

    def scene(self, where, text):
        if not re.search(r"^kind =", text, re.M):
            self.problems.append(f"{where}: a scene without kind cannot be run")
            return
        (self.work / "block.toml").write_text(text)
        self.execute(where, "softgrain run block.toml --quiet", (0,))

    def program(self, where, text):
        """The includes of a block, the rest of it inside main, and the last variable printed."""
        if not self.compiler:
            return
        head = [l for l in text.splitlines() if l.startswith("#include")]
        body = [l for l in text.splitlines() if not l.startswith("#include")]
        name, wanted = re.search(r"double (\w+) = .*// ([\d.eE+-]+)", text).groups()
        code = "\n".join(["#include <cstdio>", *head, "int main() {", *body, f'std::printf("%.17g\\n", {name}); }}\n'])
        (self.work / "block.cpp").write_text(code)
        self.execute(where, f"'{self.compiler}' -std=c++20 '-I{self.header}' block.cpp -o block", (0,))
        out = self.execute(where, "./block", (0,)) if (self.work / "block").exists() else "nan"
        if not abs(float(out) / float(wanted) - 1) < 1e-3:
            self.problems.append(f"{where}: {name} is {out.strip()}, the page says {wanted}")

    def block(self, page, language, line, text):
        where = f"{page.relative_to(self.root)}:{line}"
        if language == "sh":
            for command in commands(text):
                self.command(where, command)
        elif self.slow or language in ("", "cmake", "python"):
            pass
        elif language == "toml":
            self.scene(where, text)
        elif language == "cpp":
            self.program(where, text)
        else:
            self.problems.append(f"{where}: a block of {language}, which tests/run_blocks.py cannot run")


def run(root, program, slow, compiler, header):
    session = Session(root, program, slow, compiler, header)
    for page in pages(root):
        for language, line, text in blocks(page):
            session.block(page, language, line, text)
    print("\n".join(session.problems))
    return 1 if session.problems else 0


def show(root):
    for page in pages(root):
        for language, line, text in blocks(page):
            for command in commands(text) if language == "sh" else []:
                rule = rule_of(command)
                print(f"{page.relative_to(root)}:{line}: {command}: {rule.told() if rule else 'NO RULE'}")


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "pipelines/guide").mkdir(parents=True)
        (root / "results").mkdir()
        (root / "CMakePresets.json").write_text(
            '{\n  "configurePresets": [\n    { "name": "release" }\n  ],\n  "testPresets": [\n    { "name": "quick" }\n  ]\n}')
        page = root / "README.md"

        def problems(text):
            page.write_text(text)
            session = Session(root, "/bin/false", False, None, None)
            for language, line, block in blocks(page):
                session.block(page, language, line, block)
            return session.problems

        assert problems("```sh\ncmake --preset release  # comment\n```\n") == []
        assert "no preset debug" in problems("```sh\ncmake --preset debug\n```\n")[0]
        assert "no preset quick" in problems("```sh\ncmake --preset quick\n```\n")[0]
        assert problems("```sh\nctest --preset quick\n```\n") == []
        assert "no rule" in problems("```sh\n./softgrain dance\n```\n")[0]
        assert "status 1" in problems("```sh\n./softgrain run pipelines/quickstart.toml\n```\n")[0]
        assert "status 1" in problems('```toml\nkind = "particles"\n```\n')[0]
        assert "cannot run" in problems("```ruby\nputs 1\n```\n")[0]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", nargs="?", type=Path)
    parser.add_argument("program", nargs="?", type=Path)
    for flag in ("--slow", "--list", "--self-test"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--compiler")
    parser.add_argument("--header")
    o = parser.parse_args()
    if o.self_test:
        return self_test()
    if o.list:
        return show(o.root.resolve())
    return run(o.root.resolve(), o.program.resolve(), o.slow, o.compiler, o.header and Path(o.header).resolve())


if __name__ == "__main__":
    sys.exit(main())
