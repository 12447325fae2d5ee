#!/usr/bin/env python3
"""Writes a new contact law from the example in tests/example_law: its header, and its entries in the list of laws, the installed
header, files of laws for LAMMPS, the scenes of explicit particles, and tests. The result builds; then change the law in
its header, and the numbers that scenes and files say of it. Standard library only.

    python3 tests/new_law.py my-law
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

CONTACT = "common/contact"
SCENES = "microsim/particles/scene_contacts.cpp"
FILES = [f"{CONTACT}/law_set.h", f"{CONTACT}/laws.h", f"{CONTACT}/law_file_write.cpp", f"{CONTACT}/law_file_read.cpp",
         SCENES, "tests/unit/test_block_loop.cpp", "tests/unit/test_law_file.cpp", "tests/unit/test_contact_watch.cpp"]

WRITE = """void write(std::string& out, const std::string& name, const CAMEL& law) {
  Writer w(out, name, LawType::SNAKE);
  w.value("normal", law.normal);
  w.value("doubling_overlap", law.doubling_overlap);
}

"""
READ = """AnyLaw read_SNAKE(Reader& r) {
  CAMEL law;
  law.normal = r.positive("normal");
  law.doubling_overlap = r.positive("doubling_overlap");
  return law;
}

"""
READ_SCENE = """AnyLaw read_SNAKE(const SceneTable& t) {
  CAMEL law;
  law.normal = read_normal_stiffness(t);
  law.doubling_overlap = t.number({"doubling_overlap", "`NAME`: overlap with twice the force of a linear spring"},
                                  Unit::length, Range::positive());
  return law;
}

"""
EQUATION = """## A stiffening spring: `NAME`

    Fn = kn h (1 + h/h0)

h0 (`doubling_overlap`) is the overlap with twice the force of a linear spring. There is no friction and no damping. The time step
follows from the stiffness and from a lower bound of the duration of an impact.

"""


def words(name):
    """The name as it stands in files and functions, and in types: my_law, MyLaw."""
    return name.replace("-", "_"), "".join(part.capitalize() for part in name.split("-"))


def renamed(text, name):
    """A text of the example, or one above, with the new name."""
    snake, camel = words(name)
    text = text.replace(": the example of tests/new_law.py", "").replace("example_law", snake).replace("ExampleLaw", camel)
    return text.replace("SNAKE", snake).replace("CAMEL", camel).replace("NAME", name)


class Entries:
    """Puts entries of the law into files that list laws."""

    def __init__(self, root, name):
        self.root, self.name = root, name

    def substitute(self, file, pattern, text):
        """Replaces what the pattern finds, once; `text` may name its groups."""
        path = self.root / file
        content, count = re.subn(pattern, lambda found: found.expand(renamed(text, self.name)), path.read_text(), flags=re.S)
        if count != 1:
            raise SystemExit(f"new_law.py: {file}: '{pattern}' is there {count} times, not once: insert by hand:\n"
                             f"{renamed(text, self.name)}")
        path.write_text(content)

    def before(self, file, mark, text):
        self.substitute(file, f"(?={re.escape(mark)})", text.replace("\\", "\\\\"))


def write_law(root, name):
    """The header of the law, and its entries in all files that list laws."""
    snake, camel = words(name)
    header = root / CONTACT / f"{snake}.h"
    if header.exists():
        raise SystemExit(f"new_law.py: {header} exists")
    header.write_text(renamed((root / "tests/example_law/example_law.h").read_text(), name))
    entries = Entries(root, name)
    include = f'#include "{CONTACT}/SNAKE.h"\n'
    first = f'#include "{CONTACT}/linear_spring.h"\n'
    laws, header_of_all, write, read, *_ = FILES
    entries.before(laws, first, include)
    entries.substitute(laws, r"(using AnyLaw =\s*std::variant<.*?)>;", r"\1, CAMEL>;")
    entries.substitute(laws, r"(enum class LawType \{[^}]*?) \}", r"\1, SNAKE }")
    entries.substitute(laws, r"(enum_name_list<LawType>\(\{.*?\})\}\);", r'\1, {LawType::SNAKE, "NAME"}});')
    entries.before(header_of_all, first, include)
    row = f"//   {camel:<14} kn h (1 + h/h0)".ljust(67) + f" {snake}.h\n"
    entries.before(header_of_all, "//\n// How to use one", row)
    entries.before(write, "/// Of laws whose bodies are alike", WRITE)
    entries.before(read, "AnyLaw read_law(Reader& r) {", READ)
    entries.before(read, "    default:\n      return read_multi_contact(r);", "    case LawType::SNAKE:\n      return read_SNAKE(r);\n")
    entries.before(SCENES, "/// Spheres that move in a plane", READ_SCENE)
    entries.substitute(SCENES, r'(\{"hertz-tsuji", [^}]*)"law-card"\}', r'\1"NAME", "law-card"}')
    entries.before(SCENES, '  if (law == "law-card") soft.read(',
                   '  if (law == "NAME") out.laws.set(pair.first, pair.second, read_SNAKE(t));\n')
    entries.before("tests/unit/test_block_loop.cpp", "  for (const double adhesion : {0.0, 2e4}) {\n    out.push_back",
                   "  out.push_back(CAMEL{1e6, 0.1});\n")
    entries.before("tests/unit/test_law_file.cpp", '          {"disk", CohesiveDisk<false, false>',
                   '          {"NAME", CAMEL{1e3, 2e-3}},\n')
    entries.substitute("tests/unit/test_contact_watch.cpp", r"(const AnyLaw laws\[\] = \{)", r"\1CAMEL{7.0, 0.2}, ")
    entries.before("pipelines/guide/laws.md", "## A soft particle with one contact", EQUATION)
    try:
        subprocess.run(["clang-format-14", "-i", header, *(root / file for file in FILES)], check=True)
    except FileNotFoundError:
        print("new_law.py: clang-format-14 is not installed: format the changed files by hand", file=sys.stderr)


def compiled(copy, compiler, folder):
    """The law of the copy holds what it should, and every changed file compiles."""
    flags = [compiler, "-std=c++20", "-Wall", "-Wextra", "-Wno-psabi", "-Werror", "-I", str(copy)]
    test = copy / "tests/example_law/law_holds.cpp"
    test.write_text(renamed(test.read_text(), "self-test"))
    program = folder / "law_holds"
    subprocess.run([*flags, "-O1", str(test), "-o", str(program)], check=True)
    subprocess.run([str(program)], check=True)
    for file in (file for file in FILES if file.endswith(".cpp") and "block_loop" not in file):
        subprocess.run([*flags, "-DSPDLOG_FMT_EXTERNAL", "-fopenmp", "-fsyntax-only", str(copy / file)], check=True)


def self_test(root, compiler):
    """A copy of the repository with a law more passes the checks of sources and pages, and compiles."""
    with tempfile.TemporaryDirectory() as temporary:
        copy = pathlib.Path(temporary) / "copy"
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns("build", ".git", "*.h5", "__pycache__"))
        write_law(copy, "self-test")
        assert "xample" not in (copy / CONTACT / "self_test.h").read_text()
        for file in FILES:
            assert "SelfTest" in (copy / file).read_text() or "self_test" in (copy / file).read_text(), file
        for check in (["check_layers.py", "."], ["check_names.py", "."], ["check_guide.py", "."], ["house.py", ".", "--hold"]):
            subprocess.run([sys.executable, "tests/" + check[0], *check[1:]], cwd=copy, check=True, stdout=subprocess.DEVNULL)
        try:
            write_law(copy, "self-test")
        except SystemExit as refusal:
            assert "exists" in str(refusal)
        else:
            raise AssertionError("a law that is there was written again")
        if compiler:
            compiled(copy, compiler, pathlib.Path(temporary))
    print("new_law.py: self-test passed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="?", help="value of the key `law`: lower-case letters, with `-` between words")
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent, type=pathlib.Path,
                        help="root of the repository; default: the repository of this script")
    parser.add_argument("--self-test", action="store_true", help="try it on a copy of the repository")
    parser.add_argument("--compiler", help="with --self-test: compile the law and the changed files too")
    arguments = parser.parse_args()
    if arguments.self_test:
        return self_test(arguments.root, arguments.compiler)
    if arguments.name is None:
        parser.error("the name of the law is missing")
    if not re.fullmatch(r"[a-z]+(-[a-z]+)*", arguments.name):
        parser.error(f"'{arguments.name}': must be lower-case letters, with '-' between words")
    write_law(arguments.root, arguments.name)
    print(f"""{CONTACT}/{words(arguments.name)[0]}.h: written, with its entries in {len(FILES)} files and guide/laws.md. Next:
  change the force, the energy and the constants in the header, then what scenes and files say of its numbers
  cmake --build build/release
  python3 tests/guide_keys.py . build/release/softgrain --write
  ./softgrain test""")


if __name__ == "__main__":
    main()
