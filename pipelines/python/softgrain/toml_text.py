"""A scene that is a dict, as TOML; the standard library reads that and does not write it."""
import json
import os
import re
from collections.abc import Mapping, Sequence

import numpy as np

from softgrain.errors import InputError, Mistake

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def _plain(value):
    """numpy scalars and arrays as numbers and lists."""
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else value


def _key(name):
    return name if _BARE.fullmatch(name) else _quoted(name)


def _quoted(text):
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _refuse(path, value, allowed="must be a number, a text, True or False, or a list or dict of these"):
    raise InputError([Mistake(f"{path} = {value!r}: {allowed}", file="<scene>", key=path.rpartition(".")[2], path=path,
                            value=repr(value), allowed=allowed)])


def _require_unmasked(value, path):
    """What is masked is no value, and no number that could be left out."""
    if np.ma.is_masked(value):
        _refuse(path, value, "has masked elements: leave them out (array.compressed()) or fill them")


def value_text(value, path="value"):
    """One value, tables and lists in one line."""
    _require_unmasked(value, path)
    value = _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if np.isfinite(value) else {"inf": "inf", "-inf": "-inf", "nan": "nan"}[repr(value)]
    if isinstance(value, (str, os.PathLike)):
        return _quoted(os.fspath(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(str(k))} = {value_text(v, f'{path}.{k}')}" for k, v in value.items()) + " }"
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return "[" + ", ".join(value_text(v, f"{path}[{n}]") for n, v in enumerate(value)) + "]"
    return _refuse(path, value)


def _is_tables(value):
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(isinstance(v, Mapping) for v in value)


class _Writer:
    def __init__(self):
        self.lines = []
        self.paths = {}  # line, counted from 1: what stands there

    def put(self, line, path):
        self.lines.append(line)
        self.paths[len(self.lines)] = path

    def table(self, content, header, path):
        inner = []
        for key, value in content.items():
            place = f"{path}.{key}" if path else str(key)
            _require_unmasked(value, place)
            value = _plain(value)
            if isinstance(value, Mapping) or _is_tables(value):
                inner.append((str(key), value, place))
            elif value is not None:  # None: as if the key were not there
                self.put(f"{_key(str(key))} = {value_text(value, place)}", place)
        for key, value, place in inner:
            name = f"{header}.{_key(key)}" if header else _key(key)
            for n, one in enumerate([value] if isinstance(value, Mapping) else value):
                at = place if isinstance(value, Mapping) else f"{place}[{n}]"
                self.put(f"[{name}]" if isinstance(value, Mapping) else f"[[{name}]]", at)
                self.table(one, name, at)


def scene_text(scene):
    """TOML of a dict, and what stands in which line (counted from 1): {3: "packing.shell_radius"}. Keys that are None are left
    out. InputError for what TOML cannot say."""
    writer = _Writer()
    writer.table(scene, "", "")
    return "\n".join(writer.lines) + "\n", writer.paths


def settings(values):
    """--set options of {"packing.count": 4} or {"packing": {"count": 4}}."""
    def flat(prefix, content):
        for key, value in content.items():
            name = f"{prefix}.{key}" if prefix else str(key)
            if isinstance(value, Mapping):
                yield from flat(name, value)
            else:
                yield f"{name}={value_text(value, name)}"
    return [word for setting in flat("", values or {}) for word in ("--set", setting)]
