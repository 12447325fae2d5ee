#!/usr/bin/env python3
"""Tables of keys in the guide, made from what `softgrain schema` says.

A page holds blocks

    <!-- keys: KIND TABLE -->
    | key | meaning | allowed | default |
    <!-- /keys -->

with TABLE as in scenes (contact, loading.stage), or . for the keys at the top; behind it may follow `only A, B` or
`without A, B`. Without --write the blocks are compared; every key of every kind must be in one.

    guide_keys.py ROOT PROGRAM [--write] | --self-test
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

BLOCK = re.compile(r"<!-- keys: ([\w-]+) ([\w.]+)(?: (only|without) ([^>]*?))? -->\n(.*?)<!-- /keys -->", re.S)
HEAD = "| key | meaning | allowed | default |\n|---|---|---|---|\n"


def tables_of(text):
    """Rows of each table, from `softgrain schema KIND --to markdown`."""
    tables, name = {}, None
    for line in text.splitlines():
        if line.startswith("## "):
            name = line[3:].strip("`[] ")
            tables[name] = []
        elif line.startswith("| `"):
            tables[name].append(line)
    return tables


def name_of(row):
    return row.split("`")[1].strip("[]").split(".")[-1]


def is_table(row):
    return row.startswith("| `[")


def meaning_of(row):
    return row.split(" | ")[1]


class Schemas:
    """What the program says of each kind, asked once."""

    def __init__(self, ask):
        self.ask, self.known = ask, {}

    def of(self, kind):
        if kind not in self.known:
            self.known[kind] = tables_of(self.ask("schema", kind, "--to", "markdown"))
        return self.known[kind]

    def kinds(self):
        return [line.split()[0] for line in self.ask("schema").splitlines()[1:] if line.strip()]


def rows_of(schemas, kind, table, how, names):
    wanted = [n.strip() for n in (names or "").split(",") if n.strip()]
    all_rows = schemas.of(kind).get(table)
    if all_rows is None:
        raise KeyError(f"kind {kind} has no table {table}")
    unknown = [n for n in wanted if n not in map(name_of, all_rows)]
    if unknown:
        raise KeyError(f"{kind} {table} has no key {', '.join(unknown)}")
    if how == "only":
        return [r for r in all_rows if name_of(r) in wanted]
    return [r for r in all_rows if name_of(r) not in wanted]


def page_made(text, schemas, shown, problems, page):
    def block(match):
        kind, table, how, names, _ = match.groups()
        try:
            rows = rows_of(schemas, kind, table, how, names)
        except KeyError as error:
            problems.append(f"{page}: {error.args[0]}")
            return match.group(0)
        shown.update((name_of(r), meaning_of(r)) for r in rows)
        head = match.group(0).split("\n", 1)[0]
        return head + "\n" + HEAD + "".join(r + "\n" for r in rows) + "<!-- /keys -->"
    return BLOCK.sub(block, text)


def check(root, schemas, write):
    problems, shown = [], set()
    for page in sorted((root / "pipelines/guide").glob("*.md")):
        text = page.read_text()
        made = page_made(text, schemas, shown, problems, page.name)
        if made == text:
            continue
        if write:
            page.write_text(made)
        else:
            problems.append(f"{page.name}: its tables of keys are not those of softgrain schema: tests/guide_keys.py --write")
    for kind in schemas.kinds():
        for table, rows in schemas.of(kind).items():
            if table.endswith(".published"):  # any quantity of the results, with its error
                continue
            for row in rows:
                where = f"{kind} [{table}] {name_of(row)}"
                if not meaning_of(row):
                    problems.append(f"{where}: the reader does not say what it means")
                elif not is_table(row) and (name_of(row), meaning_of(row)) not in shown:
                    problems.append(f"{where}: is in no table of the guide")
    return problems


def self_test():
    said = {("schema",): "Kinds:\n  powder  softgrain microsim\n",
            ("schema", "powder", "--to", "markdown"):
                "## `.`\n\n" + HEAD + "| `kind` | what it is | a | - |\n\n## `[box]`\n\n" + HEAD +
                "| `low` | lower end | m | 1 |\n| `high` |  | m | 2 |\n"}
    schemas = Schemas(lambda *words: said[words])
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "pipelines/guide/p.md"
        page.parent.mkdir(parents=True)
        page.write_text("x\n<!-- keys: powder . -->\n<!-- /keys -->\n<!-- keys: powder box only low -->\n<!-- /keys -->\ny\n")
        first = check(Path(folder), schemas, False)
        assert any("are not those" in p for p in first), first
        assert check(Path(folder), schemas, True) == ["powder [box] high: the reader does not say what it means"]
        assert "| `low` | lower end | m | 1 |\n<!-- /keys -->\ny" in page.read_text() and "high" not in page.read_text()
        page.write_text(page.read_text().replace("only low", "without low"))
        assert "powder [box] low: is in no table of the guide" in check(Path(folder), schemas, True)
        page.write_text("<!-- keys: powder bax -->\n<!-- /keys -->\n")
        assert "p.md: kind powder has no table bax" in check(Path(folder), schemas, False)


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    root, program = Path(sys.argv[1]), sys.argv[2]
    schemas = Schemas(lambda *words: subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout)
    problems = check(root, schemas, "--write" in sys.argv[3:])
    print("\n".join(problems))
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
