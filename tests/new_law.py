#!/usr/bin/env python3
"""Writes a new contact law from the example in tests/example_law: its header, and its entries in the list of laws, the installed
header, files of laws for LAMMPS, the scenes of explicit particles, and tests. The result builds; then change the law in
its header, and the numbers that scenes and files say of it. Standard library only.

    python3 tests/new_law.py my-law
    cmake --build build/release
    python3 tests/guide_keys.py . build/release/softgrain --write
"""
import re
import subprocess

from new_files import Changes, parsed, self_test, words

CONTACT = "common/contact"
SCENES = "microsim/particles/scene_contacts.cpp"
GUIDE = "pipelines/guide/laws.md"
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


def renamed(text, name):
    """A text of the example, or one above, with the new name."""
    snake, camel = words(name)
    text = text.replace(": the example of tests/new_law.py", "").replace("example_law", snake).replace("ExampleLaw", camel)
    return text.replace("SNAKE", snake).replace("CAMEL", camel).replace("NAME", name)


def write_law(root, name):
    """The header of the law, and its entries in all files that list laws; all of them, or a refusal."""
    snake, camel = words(name)
    changes = Changes("new_law.py", root)
    changes.create(f"{CONTACT}/{snake}.h", renamed((root / "tests/example_law/example_law.h").read_text(), name))

    def before(file, mark, text):
        changes.before(file, mark, renamed(text, name))

    def replace(file, pattern, text):
        changes.replace(file, pattern, renamed(text, name))

    def before_words(file, mark, text):
        """Inside a string, which clang-format may have broken at any blank."""
        replace(file, "(?=" + re.escape(mark).replace(r"\ ", r'\ (?:"\s+")?') + ")", text.replace("\\", r"\\"))

    include = f'#include "{CONTACT}/SNAKE.h"\n'
    first = f'#include "{CONTACT}/linear_spring.h"\n'
    laws, header_of_all, write, read, *_ = FILES
    before(laws, first, include)
    replace(laws, r"(using AnyLaw =\s*std::variant<.*?)>;", r"\1, CAMEL>;")
    replace(laws, r"(enum class LawType \{[^}]*?),?\s*\}", r"\1, SNAKE }")
    replace(laws, r"(enum_name_list<LawType>\(\{.*?\})\}\);", r'\1, {LawType::SNAKE, "NAME"}});')
    before(header_of_all, first, include)
    row = f"//   {camel:<14} kn h (1 + h/h0)".ljust(67) + f" {snake}.h\n"
    before(header_of_all, "//\n// How to use one", row)
    before(write, "/// Of laws whose bodies are alike", WRITE)
    before(read, "AnyLaw read_law(Reader& r) {", READ)
    before(read, "    default:\n      return read_multi_contact(r);", "    case LawType::SNAKE:\n      return read_SNAKE(r);\n")
    before(SCENES, "/// Spheres that move in a plane", READ_SCENE)
    replace(SCENES, r'(\{"hertz-tsuji", [^}]*)"law-card"\}', r'\1"NAME", "law-card"}')
    before(SCENES, '  if (law == "law-card") soft.read(',
           '  if (law == "NAME") out.laws.set(pair.first, pair.second, read_SNAKE(t));\n')
    # What keys and messages say of the laws that they go with.
    before_words(SCENES, r'`\"linear-spring\"` or `\"cohesive\"`', r'`\"NAME\"`, ')
    before_words(SCENES, r'\"linear-spring\" and \"cohesive\"', r'\"NAME\", ')
    before_words(SCENES, "`linear-spring`, `cohesive`: normal stiffness", "`NAME`, ")
    before("tests/unit/test_block_loop.cpp", "  for (const double adhesion : {0.0, 2e4}) {\n    out.push_back",
           "  out.push_back(CAMEL{1e6, 0.1});\n")
    before("tests/unit/test_law_file.cpp", '          {"disk", CohesiveDisk<false, false>',
           '          {"NAME", CAMEL{1e3, 2e-3}},\n')
    replace("tests/unit/test_contact_watch.cpp", r"(const AnyLaw laws\[\] = \{)", r"\1CAMEL{7.0, 0.2}, ")
    before(GUIDE, "## A soft particle with one contact", EQUATION)
    changes.write()


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


def look(copy, folder, compiler):
    """The law and its entries in a copy of the repository, compiled where a compiler is given."""
    assert "xample" not in (copy / CONTACT / "self_test.h").read_text()
    for file in FILES:
        assert "SelfTest" in (copy / file).read_text() or "self_test" in (copy / file).read_text(), file
    assert "`self-test`, `linear-spring`, `cohesive`: normal stiffness" in (copy / SCENES).read_text()
    if compiler:
        compiled(copy, compiler, folder)


def main():
    arguments = parsed(__doc__, "law")
    if arguments.self_test:
        return self_test("new_law.py", arguments.root, write_law, (GUIDE, "## A soft particle with one contact"),
                         lambda copy, folder: look(copy, folder, arguments.compiler))
    write_law(arguments.root, arguments.name)
    print(f"""{CONTACT}/{words(arguments.name)[0]}.h: written, with its entries in {len(FILES)} files and guide/laws.md. Next:
  change the force, the energy and the constants in the header, then what scenes and files say of its numbers
  cmake --build build/release
  python3 tests/guide_keys.py . build/release/softgrain --write
  ./softgrain test""")


if __name__ == "__main__":
    main()
