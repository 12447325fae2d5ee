"""What new_law.py and new_kind.py share: names, new files and entries in files that are there, all or nothing, the test on a copy of
the repository, and the command line. Standard library only."""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def words(name):
    """The name as it stands in files and functions, and in types: my-law gives my_law, MyLaw."""
    return name.replace("-", "_"), "".join(part.capitalize() for part in name.split("-"))


class Changes:
    """New files, and texts to be put into files that are there. Nothing is written before write(), which refuses where any of them
    does not fit."""

    def __init__(self, script, root):
        self.script, self.root = script, pathlib.Path(root)
        self.content, self.mistakes = {}, []

    def create(self, path, text):
        """A file that must not be there: refused at once."""
        if (self.root / path).exists():
            raise SystemExit(f"{self.script}: {self.root / path} exists")
        self.content[path] = text

    def replace(self, path, pattern, text):
        """Replaces what the pattern finds, once; `text` may name its groups."""
        if path not in self.content:
            self.content[path] = (self.root / path).read_text()
        content, count = re.subn(pattern, lambda found: found.expand(text), self.content[path], flags=re.S)
        if count == 1:
            self.content[path] = content
        else:
            self.mistakes.append(f"{path}: '{pattern}' is there {count} times, not once: insert by hand:\n{text}")

    def before(self, path, mark, text):
        """Puts a text before another one that stands in the file once."""
        self.replace(path, f"(?={re.escape(mark)})", text.replace("\\", "\\\\"))

    def write(self):
        """Writes all files and formats the C++ files among them."""
        if self.mistakes:
            raise SystemExit(f"{self.script}: nothing was written:\n" + "\n".join(self.mistakes))
        for path, text in self.content.items():
            (self.root / path).parent.mkdir(parents=True, exist_ok=True)
            (self.root / path).write_text(text)
        sources = [str(self.root / path) for path in self.content if str(path).endswith((".h", ".cpp"))]
        try:
            subprocess.run(["clang-format-14", "-i", *sources], check=True)
        except FileNotFoundError:
            print(f"{self.script}: clang-format-14 is not installed: format the changed files by hand", file=sys.stderr)


def refusal_of(write, *arguments):
    """What it says when it refuses."""
    try:
        write(*arguments)
    except SystemExit as refusal:
        return str(refusal)
    raise AssertionError(f"{write.__name__} did not refuse")


def files_of(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def self_test(script, root, write, spoilt, look):
    """A copy of the repository where `write(copy, name)` wrote something more passes the checks of sources and pages; look(copy,
    folder) looks further. A second time is refused; so is a copy whose file spoilt[0] lacks the text spoilt[1], and stays as it is."""
    ignored = shutil.ignore_patterns("build", ".git", "*.h5", "__pycache__", "results")
    with tempfile.TemporaryDirectory() as temporary:
        bad = pathlib.Path(temporary) / "bad"
        shutil.copytree(root, bad, ignore=ignored)
        content = (bad / spoilt[0]).read_text()
        assert spoilt[1] in content
        (bad / spoilt[0]).write_text(content.replace(spoilt[1], ""))
        before = files_of(bad)
        said = refusal_of(write, bad, "self-test")
        assert "nothing was written" in said and spoilt[0] in said, said
        assert files_of(bad) == before, "a refusal left something behind"
    with tempfile.TemporaryDirectory() as temporary:
        copy = pathlib.Path(temporary) / "copy"
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns("build", ".git", "*.h5", "__pycache__"))
        write(copy, "self-test")
        look(copy, pathlib.Path(temporary))
        for check in (["check_layers.py", "."], ["check_names.py", "."], ["check_guide.py", "."], ["house.py", ".", "--hold"]):
            subprocess.run([sys.executable, "tests/" + check[0], *check[1:]], cwd=copy, check=True, stdout=subprocess.DEVNULL)
        assert "exists" in refusal_of(write, copy, "self-test")
    print(f"{script}: self-test passed")


def parsed(description, what):
    """The command line: name, --root, --self-test, --compiler. `what` has the name: law, kind."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="?", help=f"value of the key `{what}`: lower-case letters, with `-` between words")
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent, type=pathlib.Path,
                        help="root of the repository; default: the repository of this script")
    parser.add_argument("--self-test", action="store_true", help="try it on a copy of the repository")
    if what == "law":
        parser.add_argument("--compiler", help="with --self-test: compile the law and the changed files too")
    arguments = parser.parse_args()
    if not arguments.self_test:
        if arguments.name is None:
            parser.error(f"the name of the {what} is missing")
        if not re.fullmatch(r"[a-z]+(-[a-z]+)*", arguments.name):
            parser.error(f"'{arguments.name}': must be lower-case letters, with '-' between words")
    return arguments
