#!/usr/bin/env python3
"""Checks that every #include obeys the layers of the project. Standard library only.

  check_layers.py ROOT         prints each violation as file:line: what is wrong; status 1 when there is one
  check_layers.py --self-test  proves on small made-up trees that every rule can fail

Rules: common includes only itself; microsim, calibrate and macrosim only themselves and common; pipelines everything.
macrosim/lammps, which is linked with LAMMPS (GPL-2), and all that it includes carry the line of the BSD-3 licence.
Ceres appears only in .cpp files of calibrate; Eigen, FFTW, SuiteSparse, toml++, CLI11 and voro++ only in .cpp files. Folders form no cycles.
"""
import os
import re
import sys
import tempfile

MAY_INCLUDE = {
    "common": {"common"},
    "microsim": {"microsim", "common"},
    "calibrate": {"calibrate", "common"},
    "macrosim": {"macrosim", "common"},
    "pipelines": {"common", "microsim", "calibrate", "macrosim", "pipelines"},
}
OTHER_FOLDERS = {"tests", "results", "cmake", "build"}
ONLY_IN_SOURCES = {"ceres": "Ceres", "glog": "glog", "Eigen": "Eigen", "unsupported": "Eigen", "toml++": "toml++", "CLI": "CLI11",
                   "SuiteSparseQR.hpp": "SuiteSparse", "cholmod.h": "SuiteSparse", "fftw3.h": "FFTW",
                   "voro++": "voro++"}
# Headers of ours that stand for a library: they may include it, and including them counts as including it.
STANDS_FOR = {"common/io/toml.h": "toml++"}
ONLY_IN_CALIBRATE = {"ceres", "glog"}
FREE_FOLDER = "macrosim/lammps"
FREE_LINE = "SPDX-License-Identifier: BSD-3-Clause"
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')


def source_files(root):
    for layer in MAY_INCLUDE:
        for folder, _, names in sorted(os.walk(os.path.join(root, layer))):
            for name in sorted(names):
                if name.endswith((".h", ".hpp", ".cpp", ".cc")):
                    yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")


def includes(root, path):
    """Yields (line number, included path); one written relative to its file is resolved against the root."""
    with open(os.path.join(root, path), encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            quote, target = match.groups()
            beside = os.path.normpath(os.path.join(os.path.dirname(path), target)).replace(os.sep, "/")
            if quote == '"' and (target.startswith(".") or os.path.isfile(os.path.join(root, beside))):
                target = beside
            yield number, target


def violation(path, target):
    """What is wrong with `path` including `target`, or None."""
    layer = path.split("/")[0]
    first = target.split("/")[0]
    source = path.endswith((".cpp", ".cc"))
    if first in OTHER_FOLDERS or (first in MAY_INCLUDE and first not in MAY_INCLUDE[layer]):
        return f"{layer} must not include {first}/"
    library = STANDS_FOR.get(target, first)
    if first in ONLY_IN_CALIBRATE and layer != "calibrate":
        return f"{ONLY_IN_SOURCES[first]} belongs to calibrate only"
    if library in ONLY_IN_SOURCES and not source and STANDS_FOR.get(path) != library:
        return f"{ONLY_IN_SOURCES[library]} must not be included by a header"
    return None


def reachable(edges, start):
    seen, todo = set(), [start]
    while todo:
        for folder in edges.get(todo.pop(), {}):
            if folder not in seen:
                seen.add(folder)
                todo.append(folder)
    return seen


def folder_cycles(edges):
    """One message per include through which two folders depend on each other; edges[from][to] = "file:line"."""
    for start in sorted(edges):
        for end, where in sorted(edges[start].items()):
            if start in reachable(edges, end):
                yield f"{where}: folders depend on each other: {start} -> {end} -> ... -> {start}"


def unfree(root):
    """One message per file that a program with LAMMPS includes and whose licence is not the free one."""
    todo = [(path, path) for path in source_files(root) if path.startswith(FREE_FOLDER + "/")]
    # Compiled into the same program.
    todo += [(path, path) for path in source_files(root) if re.fullmatch(r"common/(contact/law_file_|io/toml_)\w+\.cpp", path)]
    seen = set()
    while todo:
        path, by = todo.pop()
        if path in seen or not os.path.isfile(os.path.join(root, path)):
            continue
        seen.add(path)
        with open(os.path.join(root, path), encoding="utf-8", errors="replace") as text:
            if FREE_LINE not in text.read():
                yield f'{by}: {path} goes into a program with LAMMPS and needs the line "{FREE_LINE}"'
        todo += [(target, path) for _, target in includes(root, path)]


def check(root):
    messages, edges = [], {}
    for path in source_files(root):
        for number, target in includes(root, path):
            problem = violation(path, target)
            if problem:
                messages.append(f'{path}:{number}: "{target}": {problem}')
            start, end = os.path.dirname(path), os.path.dirname(target)
            if target.split("/")[0] == path.split("/")[0] and start != end:
                edges.setdefault(start, {}).setdefault(end, f"{path}:{number}")
    return messages + list(folder_cycles(edges)) + list(unfree(root))


GOOD = {
    "common/core/a.h": f"// {FREE_LINE}\n#include <vector>\n",
    "common/io/b.cpp": '#include "common/core/a.h"\n#include <toml++/toml.h>\n#include <Eigen/Core>\n',
    "microsim/shell/c.h": '#include "common/core/a.h"\n#include "microsim/d.h"\n',
    "microsim/d.h": '// #include "macrosim/x.h"\n',
    "calibrate/fit.cpp": "#include <ceres/ceres.h>\n",
    "macrosim/lammps/e.cpp": f'// {FREE_LINE}\n#include "local.h"\n#include "common/core/a.h"\n',
    "macrosim/lammps/local.h": f"// {FREE_LINE}\n",
    "pipelines/main.cpp": '#include "microsim/d.h"\n#include <CLI/CLI.hpp>\n#include "generated_build_info.h"\n',
}
# Each case: a file that breaks one rule, and the start of the message that it must cause.
BAD = [
    ("common/core/x.h", '\n#include "microsim/d.h"\n', "common/core/x.h:2:"),
    ("common/core/x.h", '#include "../../pipelines/not_there.h"\n', "common/core/x.h:1:"),
    ("microsim/x.cpp", '#include "macrosim/lammps/local.h"\n', "microsim/x.cpp:1:"),
    ("microsim/x.cpp", '# include "../calibrate/fit.cpp"\n', "microsim/x.cpp:1:"),
    ("calibrate/x.cpp", "#include <microsim/d.h>\n", "calibrate/x.cpp:1:"),
    ("macrosim/x.cpp", '#include "pipelines/run/run_context.h"\n', "macrosim/x.cpp:1:"),
    ("pipelines/x.cpp", '#include "tests/support/t.h"\n', "pipelines/x.cpp:1:"),
    ("calibrate/x.h", "#include <ceres/problem.h>\n", "calibrate/x.h:1:"),
    ("pipelines/x.cpp", '#include "ceres/ceres.h"\n', "pipelines/x.cpp:1:"),
    ("microsim/x.h", "#include <Eigen/Sparse>\n", "microsim/x.h:1:"),
    ("common/io/x.h", "#include <toml++/toml.h>\n", "common/io/x.h:1:"),
    ("common/io/x.h", '#include "common/io/toml.h"\n', "common/io/x.h:1:"),
    ("pipelines/x.h", "#include <CLI/CLI.hpp>\n", "pipelines/x.h:1:"),
    ("microsim/x.h", "#include <SuiteSparseQR.hpp>\n", "microsim/x.h:1:"),
    ("common/core/x.h", "#include <voro++/voro++.hh>\n", "common/core/x.h:1:"),
    ("microsim/x.h", "#include <fftw3.h>\n", "microsim/x.h:1:"),
    ("common/core/x.h", '#include "common/io/y.h"\n', "common/core/x.h:1: folders"),
    ("microsim/d.h", '#include "microsim/shell/c.h"\n', "microsim/d.h:1: folders"),
    ("common/core/a.h", "#include <vector>\n", "macrosim/lammps/e.cpp: common/core/a.h goes into"),
    ("macrosim/lammps/x.cpp", "", "macrosim/lammps/x.cpp: macrosim/lammps/x.cpp goes into"),
]


def check_tree(files):
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            os.makedirs(os.path.join(root, os.path.dirname(path)), exist_ok=True)
            with open(os.path.join(root, path), "w", encoding="utf-8") as out:
                out.write(text)
        return check(root)


def self_test():
    failures = [f"a good tree was refused: {message}" for message in check_tree(GOOD)]
    for path, text, expected in BAD:
        messages = check_tree({**GOOD, path: text})
        if not any(message.startswith(expected) for message in messages):
            failures.append(f"missed {text.strip()!r} in {path}; got {messages}")
    for failure in failures:
        print(failure)
    print(f"{len(BAD)} rules broken on purpose, {len(failures)} failures")
    return 1 if failures else 0


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root = sys.argv[1] if len(sys.argv) == 2 else os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    if not any(True for _ in source_files(root)):
        print(f"no source files under {root}")
        return 1
    messages = check(root)
    for message in messages:
        print(message)
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())
