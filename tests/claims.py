#!/usr/bin/env python3
"""The page of claims: what three publications say, where it is in the code, and what comes out here.

    claims.py ROOT            checks the claims, and that the page is the one made from them
    claims.py ROOT --write    writes the page; claims with mistakes are named and nothing is written
    claims.py --self-test

Claims are records of pipelines/guide/claims/*.toml, one file per publication. Values of this program are never typed:
a claim says in which file its value stands, and both the page and the check read it there. Keys of a claim:

    place      section, table or figure of the publication, as far as it is known
    claim      what it says
    published  a number, 0.72(1), a range "0.09 to 0.11", a bound "< 0.01", any text, or a law {a, b, c, at}: a at^b + c
    unit       of both numbers
    code       "path:word", or several: the word occurs in the file
    test       name of a test, or several
    verdict    exact, within scatter, differs, not compared
    tolerance  that the verdict takes in place of two joint errors, in `unit`
    note       for "differs": why
    again      reading of the publication that is to be corrected (READINGS): the value is to be made again

and where the value stands, one of three ways:

    source, section, row, column   cell of a table below a heading of a Markdown page, the first that has both
    source, section, quote         "words {} words": what stands at {} in a file (in one section, where it is named)
    source, key                    "contact/kappa", "variant/name=p0/published/z" in a TOML file

`part` takes one number of several in a cell or text (0: the first); `scale` multiplies it. `says` is a text in place of
a value.
Standard library only (Python 3.11 or later).
"""
import argparse
import math
import re
import sys
import tempfile
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from guide_numbers import with_error

PAGE = Path("pipelines/guide/claims.md")
DATA = Path("pipelines/guide/claims")
FILES = ["soft_particles", "grain_boxes", "powders"]
VERDICTS = ["exact", "within scatter", "differs", "not compared"]
JOINT_ERRORS = 2.0
READINGS = {
    "frozen turn": "all grains were turned rigidly with nothing relaxing; the publication turns them slowly, in motion",
    "cut reference force": "the reference force was cut to mu P0 at every increment; the publication keeps it",
    "smooth walls": "walls had no friction; in the publication they have that of the grains",
    "own packs": "every pressure of generation had a pack of its own; the publication presses one pack on",
    "wall drag": "the shear stress was the largest drag on a wall; the publication takes the moment of the wall forces",
    "V0 as rms": "V0 was the root mean square of the speed; in the publication it is that of each component",
    "zero forces": "with rolling resistance forces below 1e-2 F0 counted as none; published is 1e-4 F0",
    "variant": "the variant that was run is not the published one",
}
KEYS = {"place", "claim", "published", "unit", "code", "test", "verdict", "tolerance", "note", "again",
        "source", "section", "row", "column", "quote", "key", "part", "scale", "says"}

DIGITS = r"[-+]?(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?(?:[eE][-+]?\d+)?"
NUMBER = re.compile(rf"({DIGITS})(?:\((\d+(?:\.\d+)?)\)|\s*(?:±|\+-)\s*({DIGITS}))?")
RANGE = re.compile(rf"({DIGITS})\s*(?: to |-)\s*({DIGITS})")
BOUND = re.compile(rf"([<>])\s*({DIGITS})")
TEST = re.compile(r"\b(?:TEST|TEST_F|TEST_P|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)")


class Wrong(Exception):
    """A claim that cannot be shown as it is."""


@dataclass
class Value:
    """A text, and where it is a number its interval (a range, a bound) and standard error."""
    text: str
    low: float = math.nan
    high: float = math.nan
    error: float = 0.0

    @property
    def numeric(self):
        return not math.isnan(self.low)


def unit_of_last_digit(digits):
    mantissa, _, exponent = digits.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def number_of(match, scale=1.0):
    digits, in_brackets, behind = match.groups()
    error = 0.0
    if behind is not None:
        error = float(behind.replace(",", ""))
    elif in_brackets is not None:
        error = float(in_brackets) * (1.0 if "." in in_brackets else unit_of_last_digit(digits))
    out = number(float(digits.replace(",", "")) * scale, error * abs(scale))
    if scale == 1.0 and error < 0.5 * unit_of_last_digit(digits):
        out.text = digits  # an error below the digits shows nowhere
    return out


def number(value, error=0.0):
    return Value(with_error(value, error) if error > 0.0 else f"{value:.6g}", value, value, error)


def value_of(text, part=None, scale=1.0):
    """A number, a range, a bound, else the text as it is. With `part` that number of the text."""
    text = text.replace("**", "").strip()
    if part is not None:
        found = list(NUMBER.finditer(text))
        if part >= len(found):
            raise Wrong(f"'{text}' has {len(found)} numbers, part {part} was asked for")
        return number_of(found[part], scale)
    if match := NUMBER.fullmatch(text):
        return number_of(match, scale)
    if match := RANGE.fullmatch(text):
        low, high = (float(x.replace(",", "")) * scale for x in match.groups())
        return Value(f"{low:.5g} to {high:.5g}", low, high)
    if match := BOUND.fullmatch(text):
        x = float(match[2].replace(",", ""))
        return Value(text, -math.inf if match[1] == "<" else x, x if match[1] == "<" else math.inf)
    return Value(text)


# Where values stand.

def section_of(text, title):
    """What stands between the first heading that contains the title and the heading after it."""
    for part in re.split(r"^#+ ", text, flags=re.M)[1:]:
        heading, _, body = part.partition("\n")
        if title in heading:
            return body
    raise Wrong(f"no heading contains '{title}'")


def cells(line):
    return [c.replace("\\|", "|").strip() for c in re.split(r"(?<!\\)\|", line.strip().strip("|"))]


def table_cell(text, row, column):
    head = None
    for line in text.splitlines():
        if not line.startswith("|"):
            head = None
        elif head is None:
            head = cells(line)
        elif column in head and cells(line)[0] == row:
            return cells(line)[head.index(column)]
    raise Wrong(f"no table has a row '{row}' and a column '{column}'")


def quoted(text, quote):
    """What stands at {}: the same wherever the words around it occur."""
    before, mark, after = (" ".join(quote.split()).partition("{}"))
    if not mark or not before:
        raise Wrong("a quote has words before its {}")
    pattern = re.escape(before) + r"([^|]+?)" + (re.escape(after) + r"(?!\d)" if after else r"(?= |$)")
    found = set(re.findall(pattern, " ".join(text.split())))
    if len(found) != 1:
        raise Wrong(f"the quote '{quote}' has {len(found)} values in the source, not one")
    return found.pop()


def toml_entry(data, key):
    """a/b/c; of a list an index, or name=value for the table in it that has this value."""
    for step in key.split("/"):
        try:
            if isinstance(data, list) and "=" in step:
                name, _, wanted = step.partition("=")
                data = next(entry for entry in data if str(entry.get(name)) == wanted)
            else:
                data = data[int(step)] if isinstance(data, list) else data[step]
        except (KeyError, IndexError, ValueError, StopIteration):
            raise Wrong(f"no key '{key}': '{step}' is not there") from None
    return data


def here(claim, root):
    """The value of this program, as the claim's source has it."""
    if "source" not in claim:
        return Value(claim.get("says", ""))
    path = root / claim["source"]
    if not path.is_file():
        raise Wrong(f"source {claim['source']} does not exist")
    part, scale = claim.get("part"), claim.get("scale", 1.0)
    if "key" in claim:
        entry = toml_entry(tomllib.loads(path.read_text()), claim["key"])
        if isinstance(entry, dict):
            return number(entry["value"] * scale, entry["standard_error"] * abs(scale))
        return value_of(entry, 0, scale) if isinstance(entry, str) else number(float(entry) * scale)
    text = path.read_text()
    if "section" in claim:
        text = section_of(text, claim["section"])
    if "quote" in claim:
        return value_of(quoted(text, claim["quote"]), part, scale)
    return value_of(table_cell(text, claim["row"], claim["column"]), part, scale)


def published(claim):
    value = claim.get("published", "")
    if isinstance(value, dict):
        at = value["a"] * value["at"] ** value["b"] + value["c"]
        return Value(f"{at:#.3g}", at, at)
    return replace(value_of(value), text=value)


# What is checked.

def several(value):
    return value if isinstance(value, list) else [value]


def check_code(claim, root):
    for place in several(claim.get("code", [])):
        path, _, word = place.partition(":")
        if not (root / path).is_file():
            yield f"code: {path} does not exist"
        elif not word or not re.search(rf"\b{re.escape(word)}\b", (root / path).read_text()):
            yield f"code: '{word}' does not occur in {path}"


def check_tests(claim, tests):
    for name in several(claim.get("test", [])):
        if name not in tests:
            yield f"test: there is no {name}"


def check_form(claim):
    yield from (f"unknown key '{key}'" for key in claim if key not in KEYS)
    yield from (f"'{key}' is missing" for key in ("place", "claim", "published", "verdict") if key not in claim)
    if claim.get("verdict") not in VERDICTS:
        yield f"verdict is one of {', '.join(VERDICTS)}"
    if claim.get("again", "frozen turn") not in READINGS:
        yield f"again is one of {', '.join(READINGS)}"
    if claim.get("verdict") == "differs" and not (claim.get("note") or claim.get("again")):
        yield "a claim that differs says why (note)"
    if "source" in claim and "says" in claim:
        yield "a claim has a source or says something, not both"
    if re.search(r"\d\(\d+\)|±|\+-", claim.get("says", "")):
        yield "a number with its error is read from a source, not typed"
    if claim.get("verdict") != "not compared" and not {"source", "says", "test"} & claim.keys():
        yield "a verdict needs a value (source, says) or a test"


def gap_between(theirs, ours):
    return max(0.0, theirs.low - ours.high, ours.low - theirs.high)


def check_verdict(claim, theirs, ours):
    """Two joint errors, or the stated tolerance, part agreement from difference."""
    verdict = claim["verdict"]
    if not (theirs.numeric and ours.numeric):
        return
    gap = gap_between(theirs, ours)
    allowed = claim.get("tolerance", JOINT_ERRORS * math.hypot(theirs.error, ours.error))
    rounding = 1e-9 * max(abs(x) for x in (ours.low, ours.high))
    text = f"{theirs.text} published, {ours.text} here, {allowed:.3g} allowed"
    if verdict == "not compared":
        yield f"both numbers are there, so they are compared: {text}"
    elif verdict == "exact" and gap > rounding:
        yield f"not exact: {text}"
    elif verdict == "within scatter" and gap > allowed + rounding:
        yield f"not within scatter: {text}"
    elif verdict == "differs" and gap <= allowed + rounding:
        yield f"does not differ: {text}"


def check_claim(claim, root, tests):
    problems = list(check_form(claim))
    if problems:
        return problems
    problems += [*check_code(claim, root), *check_tests(claim, tests)]
    try:
        problems += check_verdict(claim, published(claim), here(claim, root))
    except Wrong as wrong:
        problems.append(str(wrong))
    return problems


def names_of_tests(root):
    names = set()
    for path in (root / "tests").rglob("*.cpp"):
        names |= {".".join(found) for found in TEST.findall(path.read_text())}
    names |= set(re.findall(r"add_test\(NAME (\w+)", (root / "tests/CMakeLists.txt").read_text()))
    return names


# The page.

def plain(text):
    return " ".join(text.replace("|", "\\|").split())


def linked(place):
    path, _, word = place.partition(":")
    return f"[`{word}`](../../{path})"


def row(claim, root):
    theirs, ours = published(claim), here(claim, root)
    unit = " " + claim["unit"] if "unit" in claim else ""
    ours_text = plain(ours.text + (unit if ours.numeric else ""))
    if "source" in claim:
        ours_text = f"[{ours_text}](../../{claim['source']})"
    verdict = claim["verdict"]
    joint = math.hypot(theirs.error, ours.error)
    if "tolerance" in claim:
        verdict += f" (tolerance {claim['tolerance']:g}{unit})"
    elif joint > 0.0 and theirs.numeric and ours.numeric:
        errors = gap_between(theirs, ours) / joint
        verdict += f" ({errors:.1f} errors)" if errors < 100.0 else " (over 100 errors)"
    again = f"To be made again: {claim['again']}." if "again" in claim else ""
    code = ", ".join(linked(place) for place in several(claim.get("code", [])))
    tests = ", ".join(f"`{name}`" for name in several(claim.get("test", [])))
    note = " ".join(part for part in (plain(claim.get("note", "")), again) if part)
    theirs_text = plain(theirs.text + (unit if theirs.numeric else ""))
    return [plain(claim["place"]), plain(claim["claim"]), theirs_text, ours_text, verdict, code, tests, note]


def line(columns):
    return "| " + " | ".join(columns) + " |"


def table(head, rows):
    return [line(head), "|" + "---|" * len(head), *(line(r) for r in rows)]


def counts(publications):
    for publication in publications:
        claims = publication["claim"]
        yield [f"[{publication['title']}](#{publication['title'].lower().replace(' ', '-')})", str(len(claims)),
               *(str(sum(c["verdict"] == v for c in claims)) for v in VERDICTS), str(sum("again" in c for c in claims))]


def readings(publications):
    used = {claim.get("again") for publication in publications for claim in publication["claim"]}
    return [f"  - *{name}*: {text}" for name, text in READINGS.items() if name in used]


def page(publications, root):
    lines = [
        "# Claims: three publications, and what comes out here", "",
        "One row for each equation, step, figure and number of the publications that this program follows: where it is",
        "in the code, which test holds it, what is published and what comes out here, with the file that the value is",
        f"read from. Made by `python3 tests/claims.py . --write` from `{DATA}/*.toml`; the test `claims`",
        "checks it.", "",
        "- **exact**: the same formula, rule or number.",
        f"- **within scatter**: within {JOINT_ERRORS:g} joint standard errors, or the tolerance that is named.",
        "- **differs**: it does not; the note says why. In brackets: how many joint standard errors lie between. Where",
        "  one side has no error, that of the other counts alone.",
        "- **not compared**: nothing to compare on one of the two sides.",
        "- 0.72(1) means 0.72 ± 0.01, a standard error. \"Not at hand\": the publication has it, we do not.",
        "- **To be made again**: the row belongs to a reading of the publication that has been found wrong:",
        *readings(publications), "",
        *table(["publication", "claims", *VERDICTS, "to be made again"], counts(publications))]
    for publication in publications:
        lines += ["", f"## {publication['title']}", "", publication["reference"], "",
                  *table(["where", "claim", "published", "here", "verdict", "code", "test", "note"],
                         (row(claim, root) for claim in publication["claim"]))]
    return "\n".join(lines) + "\n"


def read_claims(root):
    return [tomllib.loads((root / DATA / (name + ".toml")).read_text()) for name in FILES]


def check(publications, root):
    tests = names_of_tests(root)
    return [f"{name}.toml, '{claim.get('claim', '?')}': {problem}" for name, publication in zip(FILES, publications)
            for claim in publication["claim"] for problem in check_claim(claim, root, tests)]


# Each check fails once.

EXAMPLE = """# Results

## Packs (one)

| pack | Phi | z |
|---|---|---|
| a | 0.725 +- 0.002 | 3.1(1), 2.9(1) |

It differs by 5 %
in the end.
"""


def self_test():
    assert value_of("0.725 +- 0.002").text == "0.7250(20)"
    assert math.isclose(value_of("12.5(1.5)").error, 1.5) and math.isclose(value_of("1.2e-2(3)").error, 3e-3)
    assert value_of("1,486").low == 1486.0 and value_of("1.05 times").numeric is False
    assert (value_of("0.09 to 0.11").low, value_of("0.09-0.11").high) == (0.09, 0.11)
    assert value_of("< 0.01").high == 0.01 and value_of("**0.061(3), 0.054(1)**", 1).text == "0.0540(10)"
    assert toml_entry({"v": [{"name": "p", "x": 2}]}, "v/name=p/x") == 2
    with tempfile.TemporaryDirectory() as work:
        root = Path(work)
        (root / "tests").mkdir()
        (root / "tests/CMakeLists.txt").write_text("add_test(NAME script COMMAND x)")
        (root / "tests/t.cpp").write_text("TEST(Suite, Name) {}")
        (root / "law.cpp").write_text("double hertz(double h);")
        (root / "page.md").write_text(EXAMPLE)
        (root / "scene.toml").write_text('[contact]\nmu = 0.3\nE = "70 GPa"\n')
        tests = names_of_tests(root)
        good = {"place": "Table 1", "claim": "Phi", "published": "0.723(1)", "source": "page.md", "section": "(one)",
                "row": "a", "column": "Phi", "code": "law.cpp:hertz", "test": ["Suite.Name", "script"],
                "verdict": "within scatter"}

        def problems(**changes):
            return check_claim({key: v for key, v in {**good, **changes}.items() if v is not None}, root, tests)

        no_cell = {"section": None, "row": None, "column": None}
        nowhere = {**no_cell, "source": None}
        mu = {**no_cell, "source": "scene.toml", "key": "contact/mu", "verdict": "exact"}
        assert problems() == []
        assert problems(**mu, published="0.3") == []
        assert problems(**{**mu, "key": "contact/E"}, published="70") == []
        assert problems(**no_cell, quote="It differs by {} %", published="4 to 6") == []
        assert problems(published="0.70", tolerance=0.03) == []
        assert problems(published="0.70", verdict="differs", note="loose") == []
        assert problems(column="z", part=1, published="3.0") == []
        wrong = {
            "code path": {"code": "lost.cpp:hertz"},
            "code word": {"code": "law.cpp:her"},
            "test": {"test": "Suite.Nam"},
            "source": {"source": "lost.md"},
            "heading": {"section": "(two)"},
            "row": {"row": "b"},
            "column": {"column": "x"},
            "part": {"column": "z", "part": 2},
            "quote": {**no_cell, "quote": "It differs by {} kg"},
            "quote of two values": {**no_cell, "quote": "0.{} "},
            "key": {**mu, "key": "contact/nu"},
            "scatter": {"published": "0.70"},
            "tolerance": {"published": "0.70", "tolerance": 0.02},
            "exact": {"verdict": "exact"},
            "exact parameter": {**mu, "published": "0.31"},
            "differs": {"verdict": "differs", "note": "x"},
            "no reason": {"verdict": "differs", "published": "0.70"},
            "compared": {"verdict": "not compared"},
            "verdict": {"verdict": "fine"},
            "reading": {"again": "x"},
            "unknown key": {"sauce": "x"},
            "missing key": {"place": None},
            "typed number": {**nowhere, "says": "0.725(2)"},
            "source and text": {"says": "x"},
            "nothing to show": {**nowhere, "test": None},
        }
        for name, changes in wrong.items():
            assert len(problems(**changes)) == 1, f"{name}: {problems(**changes)}"
        again = {**good, "published": "|x|", "again": "smooth walls"}
        publication = {"title": "One", "reference": "x", "claim": [good, again]}
        text = page([publication], root)
        assert "| [0.7250(20)](../../page.md) | within scatter (0.9 errors) |" in text
        assert "\\|x\\|" in text and "| [One](#one) | 2 | 0 | 2 | 0 | 0 | 1 |" in text
        assert all(len(cells(r)) == 8 for r in section_of(text, "One").splitlines() if r.startswith("|"))
        (root / "page.md").write_text(EXAMPLE.replace("0.725", "0.726"))
        assert page([publication], root) != text, "a page shows what its sources have"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    publications = read_claims(options.root)
    if problems := check(publications, options.root):
        sys.exit("\n".join(problems))
    text = page(publications, options.root)
    if options.write:
        (options.root / PAGE).write_text(text)
    elif (options.root / PAGE).read_text() != text:
        sys.exit(f"{PAGE} is not what its claims and their sources make: python3 tests/claims.py . --write")
    return 0


if __name__ == "__main__":
    sys.exit(main())
