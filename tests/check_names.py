#!/usr/bin/env python3
"""Names in the code and in the guide's glossary agree. Standard library only.

  check_names.py ROOT     ends with status 1, and a line for each, where
    - an identifier of the program is a word that the glossary has replaced;
    - the glossary quotes a name (`isotropic`, `law.toml`) that the program neither reads nor writes.
"""
import re
import sys
from pathlib import Path

LAYERS = ["common", "microsim", "calibrate", "macrosim", "pipelines"]
# Old words as parts of identifiers, and the present ones.
REPLACED = {
    "crowd": "multi_contact", "bag": "isotropic", "people": "console", "hasty": "short_lived", "restless": "unbalanced_fraction",
    "mantle": "thickness", "dressed": "thickened", "undressed": "thickened", "retreat": "unloading", "retreats": "unloading",
    "felt_overlap": "effective_overlap", "who_looks": "search_directions", "mistake": "error", "mistakes": "errors",
    "stand_in": "substitute", "stand_ins": "substitutes", "FileTrouble": "IoError", "BadInput": "InputError",
    "NotUsable": "UnusableResult", "HasEnded": "AlreadyFinished", "OtherRun": "FingerprintMismatch", "from_word": "parse_enum",
    "KeptStates": "SnapshotRecorder", "Carried": "ReferenceMotion", "Followed": "BestReference", "UsedUp": "SkinConsumption",
    "views": "a loop, as clang 14 does not compile views of libstdc++",
    "require_sense": "validate_combination", "take_ends": "set_size_limits", "sound": "valid",
}
NOT_CODE = re.compile(r'R"([^()\\ ]{0,16})\(.*?\)\1"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.S)
QUOTED = re.compile(r"`([^`]+)`")


def sources(root):
    return [p for layer in LAYERS for p in sorted((root / layer).rglob("*")) if p.suffix in (".h", ".cpp")]


def parts_of(identifier):
    """Itself, and the words that it is made of: crowd_law, CrowdLaw, kCrowdLaw have crowd in them."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", identifier).lower().split("_")
    return {identifier, identifier.strip("_"), *words}


def old_identifiers(path):
    for number, line in enumerate(NOT_CODE.sub(lambda m: "\n" * m.group().count("\n"), path.read_text()).splitlines(), 1):
        for identifier in set(re.findall(r"[A-Za-z_]\w*", line)):
            for old in parts_of(identifier) & REPLACED.keys():
                yield number, identifier, REPLACED[old]


def unknown_names(root):
    text = "\n".join(p.read_text() for p in sources(root))
    for line in (root / "pipelines/guide/glossary.md").read_text().splitlines():
        for name in QUOTED.findall(line):
            if name not in text:
                yield name


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    found = [f"{p.relative_to(root)}:{n}: {identifier}: the glossary says {now}"
             for p in sources(root) for n, identifier, now in old_identifiers(p)]
    found += [f"pipelines/guide/glossary.md: `{name}` is no name of the program" for name in unknown_names(root)]
    print("\n".join(found) if found else "names: the glossary and the code agree")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
