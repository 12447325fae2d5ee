"""Where the program and the compiled laws are: beside this package, in a build of the source tree, or in the system.

SOFTGRAIN_PROGRAM names a program, SOFTGRAIN_BUILD a build directory (build/release) to take both from.
"""
import importlib
import importlib.util
import os
import shutil
import sys
from functools import lru_cache
from pathlib import Path

from softgrain.errors import IoError

_HERE = Path(__file__).resolve().parent


def _builds():
    """Build directories to look in."""
    if "SOFTGRAIN_BUILD" in os.environ:
        yield Path(os.environ["SOFTGRAIN_BUILD"])
        return
    root = _HERE.parents[2]  # of the source tree, when this is pipelines/python/softgrain
    if (root / "CMakePresets.json").is_file():
        yield root / "build" / "release"


def _candidates():
    if "SOFTGRAIN_PROGRAM" in os.environ:
        yield Path(os.environ["SOFTGRAIN_PROGRAM"])
        return
    yield _HERE / "bin" / "softgrain"  # of pip install
    for build in _builds():
        yield build / "softgrain"
    found = shutil.which("softgrain")
    if found:
        yield Path(found)


def program():
    """Path of the program. IoError when there is none."""
    tried = list(_candidates())
    for path in tried:
        if path.is_file() and os.access(path, os.X_OK):
            return str(path)
    raise IoError(["the program softgrain was not found" + (f" (tried {', '.join(map(str, tried))})" if tried else "")
                       + ": install it, build it (./softgrain setup), or name it in SOFTGRAIN_PROGRAM"])


def main():
    """The command softgrain of an environment that pip installed into: becomes the program."""
    path = program()
    os.execv(path, [path, *sys.argv[1:]])


@lru_cache(maxsize=None)
def laws():
    """The compiled module with the laws. ImportError that says what to do when there is none."""
    if "SOFTGRAIN_BUILD" not in os.environ:
        try:
            return importlib.import_module("softgrain._laws")
        except ModuleNotFoundError:
            pass
    for build in _builds():
        for path in sorted((build / "python" / "softgrain").glob("_laws.*.so")):
            spec = importlib.util.spec_from_file_location("softgrain._laws", path)
            try:
                module = importlib.util.module_from_spec(spec)
            except ImportError:  # of another Python
                continue
            spec.loader.exec_module(module)
            return module
    raise ImportError("softgrain was built without its laws for this Python: install pybind11 and the headers of Python (Debian: "
                      "pybind11-dev python3-dev) and build again (./softgrain setup), or pip install --no-build-isolation .")
