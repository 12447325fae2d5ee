#!/usr/bin/env python3
"""Holds the guide to the tree: every link and picture is there, and every source that the pages for developers name. Results
that are kept are small, or named as large. The tables of keys are held by guide_keys.py.

    check_guide.py ROOT | --self-test
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

GUIDE = "pipelines/guide"

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def check_links(root):
    problems = []
    for page in [root / "README.md", *sorted((root / GUIDE).glob("*.md"))]:
        for target in LINK.findall(page.read_text()):
            if not re.match(r"[a-z]+:|#", target) and not (page.parent / target.split("#")[0]).exists():
                problems.append(f"{page.relative_to(root)}: {target} is not there")
    return problems


FENCE = re.compile(r"^```.*?^```", re.S | re.M)


def check_code(root):
    """Code is shown as it is: a link in it is no link, and nobody can copy it."""
    problems = []
    for page in [root / "README.md", *sorted((root / GUIDE).glob("*.md")), *sorted((root / "results").rglob("*.md"))]:
        for block in FENCE.findall(page.read_text()):
            problems += [f"{page.relative_to(root)}: the link to {target} stands in a block of code"
                         for target in LINK.findall(block) if re.search(r"\.md|://", target)]
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
    return check_links(root) + check_code(root) + check_paths(root) + check_sizes(root)


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / GUIDE).mkdir(parents=True)
        (root / "a.cpp").write_text("")
        page = root / GUIDE / "p.md"
        (root / "results").mkdir()
        (root / "results/small").write_bytes(b"x" * LARGEST_RESULT)
        (root / "results/large").write_bytes(b"x" * (LARGEST_RESULT + 1))
        assert [p.split()[0] for p in check_sizes(root, ["results/small", "results/large"])] == ["results/large"]
        (root / "results/README.md").write_text("one `large` file")
        assert check_sizes(root, ["results/small", "results/large"]) == []
        page.write_text("[x](nowhere.md) [y](p.md#z) [z](https://example.org)")
        (root / "README.md").write_text("")
        assert check_links(root) == [f"{GUIDE}/p.md: nowhere.md is not there"]
        page.write_text("```toml\nE = 1 # [keys](q.md#e)\n```\n[x](p.md)\n```cpp\nauto f = [x](int);\n```\n")
        assert check_code(root) == [f"{GUIDE}/p.md: the link to q.md#e stands in a block of code"], check_code(root)
        (root / GUIDE / "style.md").write_text("`pipelines/guide/p.md`, `guide/p.md`, `kinds/NAME`, `common/gone.h` and `a.cpp`")
        assert check_paths(root) == [f"{GUIDE}/style.md: `common/gone.h` is not in the tree"], check_paths(root)


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    problems = check(Path(sys.argv[1]))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
