#!/usr/bin/env python3
"""Numbers of runs in guide pages: they stand in a file beside the page, which is written by running the page's commands.

    guide_numbers.py ROOT                            the pages say exactly what the files hold (a moment)
    guide_numbers.py ROOT --write PROGRAM            runs the commands of every page and writes its file (minutes)
    guide_numbers.py ROOT --compare PROGRAM          runs them and compares every number with the file, within errors
    guide_numbers.py --self-test

pipelines/guide/numbers/PAGE.json: `results`, numbers with standard errors as the runs gave them, and `texts`, what the page must
say, made of them. Any number with its error in brackets, 697(7), that the page has beside is refused: it comes from no run.
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

GUIDE = Path("pipelines/guide")
WITH_ERROR = re.compile(r"\d[\d,.]*\(\d+\)")
# How far numbers of two machines may lie apart, in joint standard errors: other processors round differently, and packings of
# grains take other paths then.
JOINT_ERRORS = 4.0

MODULI = {"loading": "constrained modulus, upper half of the stress, loading", "unloading": "constrained modulus, whole stage, unload",
          "begin": "constrained modulus at the begin, loading", "unloading begin": "constrained modulus at the begin, unload",
          "ratio": "lateral over axial stress at the end", "fraction": "solid fraction at the start"}


def with_error(value, error, unit=1.0):
    """697(7): two digits of an error that begins with 1 or 2, else one; thousands apart."""
    value, error = value / unit, error / unit
    if not (error > 0.0 and math.isfinite(error)):
        return f"{value:,.4g}"
    decimals = -math.floor(math.log10(error))
    if f"{error:.0e}"[0] in "12":
        decimals += 1
    if decimals <= 0:
        return f"{value:,.0f}({error:.0f})"
    return f"{value:,.{decimals}f}({round(error * 10 ** decimals)})"


class Page:
    """Commands in their order, each with a name for its results, and how the page says them."""

    def __init__(self, name, scene, commands, texts):
        self.name, self.scene, self.commands, self.texts = name, scene, commands, texts

    def path(self, root):
        return root / GUIDE / (self.name + ".md")

    def file(self, root):
        return root / GUIDE / "numbers" / (self.name + ".json")


def mpa(number):
    return with_error(number["value"], number["standard_error"], 1e6)


def plain(number):
    return with_error(number["value"], number["standard_error"])


def first_hour_texts(r):
    sand = r["sand"][""]
    texts = [f"{mpa(sand['loading'])} MPa from 2.5 to 5 MPa, {mpa(sand['unloading'])} MPa from 5 back to 3.5 MPa",
             f"{mpa(sand['begin'])} MPa at 0.7 MPa, {mpa(sand['unloading begin'])} MPa as unloading begins"]
    for point, v in r["sizes"].items():
        grains = int(float(point.split("=")[1]))
        texts.append(f"| {grains:,} | {mpa(v['loading'])} | {mpa(v['unloading'])} | {plain(v['ratio'])} |")
    names = {"preparation = fast": "fast", "compaction_mu = 0.3": "the same, `compaction_mu = 0.3`",
             "compaction_mu = 0.1": "the same, `compaction_mu = 0.1`", "preparation = frictionless": "frictionless"}
    prepared = {**r["preparations"], **r["frictions of preparation"]}
    for point, label in names.items():
        v = prepared[point]
        texts.append(f"| {label} | {plain(v['fraction'])} | {mpa(v['loading'])} | {mpa(v['unloading'])} | {plain(v['ratio'])} |")
    frictions = list(r["frictions"].values())
    texts.append(", ".join(mpa(v["loading"]) for v in frictions) + " MPa in loading")
    texts.append(", ".join(mpa(v["unloading"]) for v in frictions) + " in unloading")
    texts.append("solid fractions " + ", ".join(plain(v["fraction"]) for v in frictions))
    return texts


PAGES = [
    Page("first_hour", "my_scene.toml",
         {"sand": "run my_scene.toml --out results/my_sand",
          "sizes": "sweep my_scene.toml --over grains.count=500,1000,2000,4000 --set samples=4 --out results/my_sizes",
          "preparations": "sweep my_scene.toml --over packing.preparation=fast,frictionless --out results/my_preparations",
          "frictions of preparation": "sweep my_scene.toml --over packing.compaction_mu=0.1,0.3 --out results/my_compactions",
          "frictions": "sweep my_scene.toml --over material.mu=0.3,0.5,0.7 --out results/my_frictions"},
         first_hour_texts),
]


def numbers_of_set(summary):
    """Of a sweep: point by point, by the names that RunValues have."""
    out = {}
    for point in summary["points"]:
        by_name = {n["name"]: {"value": n["mean"], "standard_error": n["standard_error"]} for n in point["numbers"]}
        out[point["name"]] = {short: by_name[name] for short, name in MODULI.items() if name in by_name}
    return out


def numbers_of_run(summary):
    variant = summary["variants"][0]
    stages = {s["name"]: s for s in variant["stages"]}

    def of(mean):
        return {"value": mean["mean"], "standard_error": mean["standard_error"]}

    return {"": {"loading": of(stages["loading"]["modulus_secant"]), "unloading": of(stages["unload"]["modulus_secant"]),
                 "begin": of(stages["loading"]["modulus_begin"]), "unloading begin": of(stages["unload"]["modulus_begin"]),
                 "fraction": of(variant["solid_fraction_start"])}}


def scene_of(page, root):
    blocks = re.findall(r"```toml\n(.*?)```", page.path(root).read_text(), re.S)
    return blocks[0]


def run_page(page, root, program, work):
    """All results of a page, in a directory where paths are those of the root."""
    for name in ("pipelines", "results"):
        if name == "pipelines":
            os.symlink(root / name, work / name)
        else:
            (work / name).mkdir()
    (work / page.scene).write_text(scene_of(page, root))
    text = page.path(root).read_text()
    results = {}
    for name, command in page.commands.items():
        # The page shows the command, with or without a place for its results.
        shown = command if command in text else command.split(" --out ")[0]
        if shown not in text and shown.replace("sweep my_scene.toml ", "") not in text:
            sys.exit(f"{page.name}.md: does not show the command '{shown}'")
        print(f"{page.name}: {command}", file=sys.stderr, flush=True)
        done = subprocess.run([program, *command.split(), "--quiet"], cwd=work, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{command}: ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
        summary = json.loads((work / command.split("--out ")[1] / "summary.json").read_text())
        results[name] = numbers_of_set(summary) if "points" in summary else numbers_of_run(summary)
    return results


def flat(results, before=()):
    if isinstance(results, dict) and "value" in results:
        yield before, results
    elif isinstance(results, dict):
        for key, value in results.items():
            yield from flat(value, (*before, key))


def spaceless(text):
    return re.sub(r"\s+", " ", text)


def check_page(text, kept, texts, name):
    """The file's texts are those of its numbers, the page has them all, and no other number with an error."""
    problems = []
    if kept["texts"] != texts:
        problems.append(f"numbers/{name}.json: `texts` are not those of its `results`: write it with --write")
    page = spaceless(text)
    rest = page
    for one in kept["texts"]:
        if spaceless(one) not in page:
            problems.append(f"{name}.md: does not say \"{one}\", which its commands give")
        rest = rest.replace(spaceless(one), " ")
    problems += [f"{name}.md: '{n}' is no number of numbers/{name}.json" for n in WITH_ERROR.findall(rest)]
    return problems


def compare(kept, fresh):
    problems = []
    now = dict(flat(fresh))
    for key, old in flat(kept):
        new = now.get(key)
        if new is None:
            problems.append(f"{'/'.join(key)}: is not there any more")
            continue
        joint = math.hypot(old["standard_error"] or 0.0, new["standard_error"] or 0.0)
        if not abs(new["value"] - old["value"]) <= JOINT_ERRORS * joint + 1e-12 * abs(old["value"]):
            problems.append(f"{'/'.join(key)}: {new['value']:.6g} now, {old['value']:.6g} in the file; joint error {joint:.2g}")
    return problems


def self_test():
    assert with_error(697.3e6, 7.2e6, 1e6) == "697(7)"
    assert with_error(1185.4e6, 28e6, 1e6) == "1,185(28)"
    assert with_error(0.6162, 0.0021) == "0.6162(21)"
    assert with_error(0.7441, 0.0312) == "0.74(3)"
    assert with_error(12.0, math.nan) == "12"
    kept = {"texts": ["697(7) MPa"]}
    assert check_page("so: 697(7)\nMPa here", kept, ["697(7) MPa"], "p") == []
    assert len(check_page("so: 698(7) MPa", kept, ["697(7) MPa"], "p")) == 2
    assert len(check_page("697(7) MPa, and 12.5(3)", kept, ["697(7) MPa"], "p")) == 1
    assert len(check_page("697(7) MPa", kept, ["700(7) MPa"], "p")) == 1
    old = {"a": {"b": {"value": 1.0, "standard_error": 0.1}}}
    assert compare(old, {"a": {"b": {"value": 1.4, "standard_error": 0.1}}}) == []
    assert len(compare(old, {"a": {"b": {"value": 1.6, "standard_error": 0.1}}})) == 1
    assert len(compare(old, {})) == 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?")
    parser.add_argument("--write", metavar="PROGRAM")
    parser.add_argument("--compare", metavar="PROGRAM")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    root = Path(options.root).resolve()
    problems = []
    for page in PAGES:
        program = options.write or options.compare
        if program:
            with tempfile.TemporaryDirectory() as work:
                fresh = run_page(page, root, str(Path(program).resolve()), Path(work))
        if options.write:
            page.file(root).parent.mkdir(exist_ok=True)
            kept = {"page": page.name + ".md", "commands": page.commands, "results": fresh, "texts": page.texts(fresh)}
            page.file(root).write_text(json.dumps(kept, indent=1) + "\n")
            print("\n".join(kept["texts"]))
        kept = json.loads(page.file(root).read_text())
        if kept["commands"] != page.commands:
            problems.append(f"{page.name}: its file was made by other commands")
        if options.compare:
            problems += compare(kept["results"], fresh)
        elif not options.write:
            problems += check_page(page.path(root).read_text(), kept, page.texts(kept["results"]), page.name)
    if problems:
        sys.exit("\n".join(problems))
    return 0


if __name__ == "__main__":
    sys.exit(main())
