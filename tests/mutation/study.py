#!/usr/bin/env python3
"""Which errors would the tests notice? Changes one sign, factor, index or comparison at a time and runs them. Standard library only.

    study.py [BUILD] [--work DIR] [--copy DIR] [--only NAME]... [--again NAME]... [--first-only] [--jobs N]
    study.py --list        what would be changed
    study.py --self-test   seconds: every text still stands where it is looked for, and the machinery refuses what it should

The mutations are in mutations.toml. Each is made in a copy of the tree (never in the tree itself), built incrementally, and tried
first by the tests that should notice it, then by the rest of the default suite, until one fails. BUILD, a build folder or a program
in one, says with which options to build; without it, as `cmake --preset release`. What is known of a mutation is kept in DIR/results:
a study that was stopped goes on, and a changed mutation, or one given with --again, is tried again. The table is DIR/table.md.
--first-only leaves the rest of the suite to a later call. --copy puts the copy elsewhere: a compiler cache knows files by their place
(CMAKE_CXX_COMPILER_LAUNCHER from the environment). Hours from nothing, on two cores; minutes per mutation.
"""
import argparse
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
TREE = HERE.parent.parent
LIST = HERE / "mutations.toml"
MARK = ".copy-for-mutations"  # in a copy: what may be overwritten
LIMIT = 1800  # seconds for one program of tests; a mutation may leave a loop without end
SKIPPED = "slow|browser"  # labels outside the default suite
TAKEN_OVER = ("CMAKE_BUILD_TYPE", "CMAKE_CXX_COMPILER", "CMAKE_C_COMPILER", "CMAKE_CXX_FLAGS", "SOFTGRAIN_NATIVE",
              "SOFTGRAIN_LAMMPS", "SOFTGRAIN_WERROR", "SOFTGRAIN_SANITIZE")


class Trouble(Exception):
    """Something is wrong with the study itself, not with a mutation."""


def read_list(path=LIST):
    mutations = tomllib.loads(path.read_text(encoding="utf-8"))["mutation"]
    for m in mutations:
        if sorted(m) != ["file", "find", "name", "replace", "tests"]:
            raise Trouble(f"mutation {m.get('name')}: keys must be name, file, find, replace, tests")
        if m["find"] == m["replace"]:
            raise Trouble(f"mutation {m['name']}: changes nothing")
    names = [m["name"] for m in mutations]
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise Trouble(f"mutations of one name: {', '.join(twice)}")
    return mutations


def mutated(text, m):
    """The text of the file with the mutation in it."""
    count = text.count(m["find"])
    if count != 1:
        raise Trouble(f"mutation {m['name']}: {m['file']} holds {count} times what it holds once: {m['find']!r}")
    return text.replace(m["find"], m["replace"])


def fingerprint(m):
    return hashlib.sha256(json.dumps(m, sort_keys=True).encode()).hexdigest()


# The copy ---------------------------------------------------------------------------------------------------------------


def files_of(tree):
    """What belongs to the tree: what git knows or does not ignore; without git all but builds."""
    git = subprocess.run(["git", "-C", str(tree), "ls-files", "-z", "--cached", "--others", "--exclude-standard"], capture_output=True)
    if git.returncode == 0:
        return sorted(p for p in git.stdout.decode().split("\0") if p and (tree / p).is_file())
    found = (p.relative_to(tree) for p in tree.rglob("*") if p.is_file() and not p.is_symlink())
    return sorted(str(p) for p in found if p.parts[0] not in ("build", ".git", ".cache"))


def refresh(tree, copy):
    """Makes the copy what the tree is; files that are equal keep their times, so that little is built again. Whether any were not."""
    if copy == tree or copy in tree.parents:
        raise Trouble(f"{copy}: the copy must not be the tree itself")
    if copy.exists() and any(copy.iterdir()) and not (copy / MARK).exists():
        raise Trouble(f"{copy}: is not empty and no copy of an earlier study")
    copy.mkdir(parents=True, exist_ok=True)
    (copy / MARK).touch()
    wanted = set(files_of(tree))
    changed = False
    for path in files_of_copy(copy):
        if path not in wanted:
            (copy / path).unlink()
            changed = True
    for path in sorted(wanted):
        source, target = tree / path, copy / path
        if target.is_file() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        target.unlink(missing_ok=True)
        shutil.copyfile(source, target)
        shutil.copymode(source, target)
        changed = True
    return changed


def files_of_copy(copy):
    out = []
    for folder, names, files in os.walk(copy):
        if Path(folder) == copy:
            names[:] = [n for n in names if n not in ("build", ".git")]
            files = [f for f in files if f != MARK]
        out += [str((Path(folder) / f).relative_to(copy)) for f in files]
    return out


class Mutation:
    """A mutation in the copy, as long as the block lasts."""

    def __init__(self, copy, m):
        self.path, self.m = copy / m["file"], m

    def __enter__(self):
        self.text = self.path.read_text(encoding="utf-8")
        self.path.write_text(mutated(self.text, self.m), encoding="utf-8")

    def __exit__(self, *_):
        self.path.write_text(self.text, encoding="utf-8")


# Building and testing -----------------------------------------------------------------------------------------------------


def taken_over(build):
    """Options of a build folder, for cmake."""
    folder = Path(build).resolve()
    if folder.is_file():
        folder = folder.parent
    cache = folder / "CMakeCache.txt"
    if not cache.is_file():
        raise Trouble(f"{build}: no build folder (no CMakeCache.txt), and no program in one")
    known = dict(re.findall(r"^([A-Za-z_]+):[A-Z]+=(.*)$", cache.read_text(errors="replace"), re.MULTILINE))
    return [f"-D{k}={known[k]}" for k in TAKEN_OVER if known.get(k)]


class Study:
    def __init__(self, copy, work, build, jobs):
        self.copy, self.work, self.jobs = copy, work, jobs
        self.options = taken_over(build) if build else ["-DCMAKE_BUILD_TYPE=Release"]
        self.folder = copy / "build" / "release"

    def run(self, words, limit=None):
        """Exit status (None: out of time) and what was said, which also goes to the log."""
        with open(self.work / "log.txt", "ab") as log:
            log.write(f"\n$ {' '.join(words)}\n".encode())
            log.flush()
            start = log.tell()
            child = subprocess.Popen(words, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True)
            try:
                status = child.wait(limit)
            except subprocess.TimeoutExpired:
                os.killpg(child.pid, 9)
                child.wait()
                status = None
            except BaseException:
                os.killpg(child.pid, 9)
                raise
        with open(self.work / "log.txt", "rb") as log:
            log.seek(start)
            return status, log.read().decode(errors="replace")

    def configure(self):
        words = ["cmake", "-S", str(self.copy), "-B", str(self.folder), "-G", "Ninja", "-DSOFTGRAIN_TESTS=ON", *self.options]
        launcher = os.environ.get("CMAKE_CXX_COMPILER_LAUNCHER")
        if launcher:
            words.append(f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}")
        status, said = self.run(words)
        if status != 0:
            raise Trouble(f"cmake failed:\n{said[-2000:]}")

    def build(self, targets=()):
        """Whether it could be built; without targets everything."""
        words = ["cmake", "--build", str(self.folder), f"-j{self.jobs}"]
        return self.run(words + (["--target", *targets] if targets else []))[0] == 0

    def first_tests(self, tests):
        """Runs tests of a mutation. None, or who failed."""
        for test in tests:
            program, pattern = test.split(": ", 1)
            if program == "ctest":
                failed = self.suite("-R", pattern)
            else:
                words = [str(self.folder / "tests" / program), f"--gtest_filter={pattern}:-*Slow*", "--gtest_fail_fast"]
                status, said = self.run(words, LIMIT)
                names = re.findall(r"^\[  FAILED  \] ([\w./]+)", said, re.MULTILINE)
                ended = "out of time" if status is None else f"ended with {status}"
                running = re.findall(r"^\[ RUN      \] ([\w./]+)", said, re.MULTILINE)
                failed = None if status == 0 else names[0] if names else f"{(running or [program])[-1]} ({ended})"
            if failed:
                return failed
        return None

    def suite(self, *more):
        """The default suite, to the first failure. None, or who failed."""
        words = ["ctest", "--test-dir", str(self.folder), "-LE", SKIPPED, "--stop-on-failure", f"-j{self.jobs}", *more]
        status, said = self.run(words, 4 * LIMIT)
        if status == 0:
            return None
        names = re.findall(r"^\s*\d+ - (\S+)", said[said.rfind("The following tests FAILED"):], re.MULTILINE)
        return names[0] if names else f"ctest (ended with {status})"

    def programs(self, mutations):
        named = {t.split(": ", 1)[0] for m in mutations for t in m["tests"]}
        return [] if "ctest" in named else sorted(named)


def result_file(work, m):
    return work / "results" / f"{m['name']}.json"


def known(work, m):
    path = result_file(work, m)
    if not path.is_file():
        return None
    result = json.loads(path.read_text(encoding="utf-8"))
    return result if result["fingerprint"] == fingerprint(m) else None


def keep(work, m, outcome, by, seconds):
    """Writes down what came out, at once."""
    result = {"fingerprint": fingerprint(m), "outcome": outcome, "by": by, "seconds": round(seconds)}
    path = result_file(work, m)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.with_suffix(".tmp").write_text(json.dumps(result, indent=1), encoding="utf-8")
    path.with_suffix(".tmp").replace(path)


def write_table(work, mutations):
    rows = ["| mutation | file | outcome |", "|---|---|---|"]
    caught = 0
    for m in mutations:
        result = known(work, m)
        text = "not run" if result is None else f"{result['outcome']}{' by `' + result['by'] + '`' if result['by'] else ''}"
        caught += result is not None and result["outcome"] == "caught"
        rows.append(f"| {m['name']} | `{m['file']}` | {text} |")
    rows.append(f"\n{caught} of {len(mutations)} caught.")
    (work / "table.md").write_text("\n".join(rows) + "\n", encoding="utf-8")
    return caught


def note(work, mutations, m, outcome, by, seconds):
    """Keeps it, says it, and brings the table up to date."""
    keep(work, m, outcome, by, seconds)
    print(f"{m['name']}: {outcome}{' by ' + by if by else ''} ({seconds:.0f} s)", flush=True)
    write_table(work, mutations)


def baseline(study, what, key, body):
    """The tree without mutation must pass, or everything would count as caught."""
    path = study.work / "results" / f"unchanged-{key}.ok"
    if path.is_file():
        return
    failed = body()
    if failed:
        raise Trouble(f"{what} fails without any mutation: {failed}")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()


def first_round(study, mutations):
    """The tests that should notice."""
    todo = [m for m in mutations if known(study.work, m) is None]
    if not todo:
        return
    programs = study.programs(todo)
    if not study.build(programs):
        raise Trouble(f"the tree does not build; see {study.work / 'log.txt'}")
    for m in todo:
        key = hashlib.sha256(json.dumps(m["tests"]).encode()).hexdigest()[:16]
        baseline(study, ", ".join(m["tests"]), key, lambda m=m: study.first_tests(m["tests"]))
    for m in todo:
        start = time.time()
        with Mutation(study.copy, m):
            if not study.build(study.programs([m])):
                note(study.work, mutations, m, "does not build", "", time.time() - start)
                continue
            failed = study.first_tests(m["tests"])
        note(study.work, mutations, m, "caught" if failed else "left to the suite", failed or "", time.time() - start)


def second_round(study, mutations):
    """The rest of the suite, for what the first round let through."""
    todo = [m for m in mutations if (known(study.work, m) or {}).get("outcome") == "left to the suite"]
    if not todo:
        return
    if not study.build():
        raise Trouble(f"the tree does not build; see {study.work / 'log.txt'}")
    baseline(study, "the default suite", "suite", study.suite)
    for m in todo:
        start = time.time()
        with Mutation(study.copy, m):
            failed = study.suite() if study.build() else "nothing: does not build with all targets"
        note(study.work, mutations, m, "caught" if failed else "SURVIVED", failed or "", time.time() - start)


# Self-test ----------------------------------------------------------------------------------------------------------------


def tests_of_the_tree():
    """Names of all tests: "tests_unit" -> {"Suite.Name"}, of property tests and parametrised ones the suite."""
    out = {}
    for path in sorted((TREE / "tests").rglob("*.cpp")):
        program = "tests_" + path.relative_to(TREE / "tests").parts[0]
        text = path.read_text(encoding="utf-8")
        for suite, name in re.findall(r"\b(?:TEST|TEST_F|TEST_P|TYPED_TEST|RC_GTEST_PROP)\((\w+),\s*(\w+)", text):
            out.setdefault(program, set()).add(f"{suite}.{name}")
    return out


def refused(body):
    try:
        body()
    except Trouble:
        return True
    return False


def self_test():
    failures = []
    mutations = read_list()
    tests = tests_of_the_tree()
    if len(mutations) < 30:
        failures.append(f"{len(mutations)} mutations, at least 30 wanted")
    for m in mutations:
        try:
            mutated((TREE / m["file"]).read_text(encoding="utf-8"), m)
        except (Trouble, OSError) as e:
            failures.append(str(e))
        for test in m["tests"]:
            program, patterns = test.split(": ", 1)
            for pattern in patterns.split(":"):
                wanted = re.compile(re.escape(pattern).replace(r"\*", ".*") + "$")
                if program != "ctest" and not any(wanted.match(t) for t in tests.get(program, ())):
                    failures.append(f"mutation {m['name']}: {program} has no test {pattern}")
    m = {"name": "a", "file": "a.cpp", "find": "x + y", "replace": "x - y", "tests": []}
    machinery = {
        "a text that is gone": refused(lambda: mutated("x * y", m)),
        "a text that stands twice": refused(lambda: mutated("x + y; x + y", m)),
        "the tree as its own copy": refused(lambda: refresh(TREE, TREE)),
        "a folder above the tree": refused(lambda: refresh(TREE, TREE.parent)),
        "a build folder that is none": refused(lambda: taken_over(HERE)),
    }
    with tempfile.TemporaryDirectory() as folder:
        tree, copy = Path(folder) / "tree", Path(folder) / "copy"
        for path, text in {"a.cpp": "return x + y;\n", "sub/b.cpp": "b\n"}.items():
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            (tree / path).write_text(text)
        (Path(folder) / "full").mkdir()
        (Path(folder) / "full" / "mine").touch()
        machinery["a folder with other things in it"] = refused(lambda: refresh(tree, Path(folder) / "full"))
        refresh(tree, copy)
        old = (copy / "sub/b.cpp").stat().st_mtime_ns
        with Mutation(copy, m):
            inside = (copy / "a.cpp").read_text()
        (tree / "sub/c.cpp").write_text("c\n")
        (tree / "a.cpp").write_text("return x + y + 1;\n")
        refresh(tree, copy)
        machinery["a copy is changed and put back, the tree never"] = (
            inside == "return x - y;\n" and (tree / "a.cpp").read_text() == "return x + y + 1;\n"
            and (copy / "a.cpp").read_text() == "return x + y + 1;\n" and (copy / "sub/c.cpp").exists()
            and (copy / "sub/b.cpp").stat().st_mtime_ns == old)
        keep(copy, m, "caught", "Some.Test", 1.0)
        machinery["results are kept and belong to their mutation"] = (
            known(copy, m)["outcome"] == "caught" and known(copy, {**m, "replace": "x * y"}) is None)
    failures += [f"the machinery fails at: {what}" for what, good in machinery.items() if not good]
    for failure in failures:
        print(failure)
    print(f"{len(mutations)} mutations looked up, {len(failures)} failures")
    return 1 if failures else 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", help="a build folder, or a program in one: its options are taken over")
    parser.add_argument("--work", type=Path, default=TREE / "build" / "mutation", help="results, log and table")
    parser.add_argument("--copy", type=Path, help="the copy of the tree (default: WORK/tree)")
    parser.add_argument("--only", action="append", default=[], help="this mutation only (repeatable)")
    parser.add_argument("--again", action="append", default=[], help="forget what is known of this mutation (repeatable)")
    parser.add_argument("--first-only", action="store_true", help="only the tests that should notice")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    return parser.parse_args()


def main():
    given = arguments()
    if given.self_test:
        return self_test()
    mutations = read_list()
    if given.list:
        for m in mutations:
            print(f"{m['name']}: {m['file']}\n  - {m['find']}\n  + {m['replace']}\n  {'; '.join(m['tests'])}")
        return 0
    unknown = [n for n in given.only + given.again if n not in {m["name"] for m in mutations}]
    if unknown:
        raise Trouble(f"no mutation {', '.join(unknown)}; --list names them")
    work = given.work.resolve()
    copy = (given.copy or work / "tree").resolve()
    work.mkdir(parents=True, exist_ok=True)
    if refresh(TREE, copy):  # what passed before may fail now
        for path in (work / "results").glob("unchanged-*.ok"):
            path.unlink()
    for m in mutations:
        if m["name"] in given.again:
            result_file(work, m).unlink(missing_ok=True)
    study = Study(copy, work, given.build, given.jobs)
    study.configure()
    chosen = [m for m in mutations if not given.only or m["name"] in given.only]
    first_round(study, chosen)
    if not given.first_only:
        second_round(study, chosen)
    caught = write_table(work, mutations)
    print(f"{caught} of {len(mutations)} caught; {work / 'table.md'}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(130))  # ends what it started
    try:
        sys.exit(main())
    except Trouble as e:
        print(f"study.py: {e}", file=sys.stderr)
        sys.exit(1)
