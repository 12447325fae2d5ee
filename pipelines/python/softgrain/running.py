"""Runs of scenes and checks of them: the program in a process of its own, so that Ctrl-C, a crash or a full memory end the run and
not Python."""
import html
import json
import os
import pty
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from collections.abc import Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from softgrain import installation
from softgrain.errors import InputError, IoError, Interrupted, UnusableResult, SoftgrainError, error_of
from softgrain.figures import Drawn
from softgrain.tables import counted
from softgrain.results import Run
from softgrain.toml_text import scene_text, settings


def _is_text(scene):
    """TOML itself and not the name of a file."""
    return isinstance(scene, str) and "\n" in scene


@contextmanager
def scene_file(scene):
    """Path of the scene, and what stands in its lines (None for a file). A dict or a text goes into a file in the working directory for
    the while, so that paths in it are relative to that."""
    if not isinstance(scene, Mapping) and not _is_text(scene):
        yield os.fspath(scene), None
        return
    text, paths = (scene, {}) if _is_text(scene) else scene_text(scene)
    try:
        file = tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=".", prefix=".softgrain-", suffix=".toml", delete=False)
    except OSError as e:
        raise IoError([f"a scene that is no file needs a file in the working directory: {e}"]) from e
    try:
        with file:
            file.write(text)
        yield os.path.relpath(file.name), paths
    finally:
        with suppress(OSError):
            os.unlink(file.name)


def _kind(scene, overrides):
    """Of a scene; what is wrong with it the program says better."""
    if overrides and "kind" in overrides:
        return overrides["kind"]
    if isinstance(scene, Mapping):
        return scene.get("kind")
    try:
        if _is_text(scene):
            return tomllib.loads(scene).get("kind")
        return tomllib.loads(Path(scene).read_text(encoding="utf-8-sig")).get("kind")
    except (OSError, ValueError):
        return None


def run_directory(scene, overrides):
    """results/NAME of the scene, of a dict or text results/KIND; not a folder with a page that is kept (as the program chooses)."""
    name = str(_kind(scene, overrides) or "scene") if isinstance(scene, Mapping) or _is_text(scene) else Path(scene).stem
    directory = Path("results") / name
    return directory.with_name(name + "_run") if (directory / "README.md").exists() else directory


# ---- what the program says while it runs

_COMPLAINT = re.compile(r"softgrain: (?!warning:)")  # what the exception will say
_BAR = re.compile(r"^(?P<what>.*?)(?: \[[#.]*\])? +(?P<percent>\d+) %, (?P<rest>.*)$")


class Teller:
    """Gets what a run says: tell(share, text), share from 0 to 1 of what it is at now, None for a line of its log."""

    def __init__(self, progress):
        self.callback = progress if callable(progress) else None
        self.quiet = not progress
        self.live = sys.stderr is not None and (sys.stderr.isatty() or "ipykernel" in sys.modules)
        self.width = 0
        self.last_line = time.monotonic()

    def __call__(self, text):
        bar = _BAR.match(text)
        share = int(bar["percent"]) / 100.0 if bar else None
        if bar:
            text = f"{bar['what']}: {bar['percent']} %, {bar['rest']}"
        if self.callback is not None:
            self.callback(share, text)
        elif not self.quiet and sys.stderr is not None:
            self._show(share, text)

    def _show(self, share, text):
        if share is None:
            print("\r" + text.ljust(self.width) if self.width else text, file=sys.stderr, flush=True)
            self.width = 0
        elif self.live:
            print("\r" + text.ljust(self.width), end="", file=sys.stderr, flush=True)
            self.width = len(text)
        elif time.monotonic() - self.last_line > 30.0:
            print(text, file=sys.stderr, flush=True)
            self.last_line = time.monotonic()

    def end(self):
        """No half line is left."""
        if self.width:
            print(file=sys.stderr, flush=True)
            self.width = 0


def _follow(terminal, teller, child):
    """Hands on what the program writes to its terminal, line by line; a bar is a line that another one replaces. An error of the callback
    stops the run and is given back."""
    buffer = ""
    trouble = None
    while True:
        try:
            data = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            break
        if not data:
            break
        *whole, buffer = re.split(r"[\r\n]+", buffer + data.decode(errors="replace"))
        for line in whole:
            line = line.replace("\033[K", "").rstrip()
            try:
                if line and trouble is None and not _COMPLAINT.match(line):
                    teller(line)
            except Exception as e:  # pylint: disable=broad-except
                trouble = e
                child.send_signal(signal.SIGINT)
    return trouble


def _stop(child):
    """Asks for an orderly end, as often as somebody presses Ctrl-C ever less politely."""
    for wish in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        with suppress(ProcessLookupError):
            child.send_signal(wish)
        try:
            child.wait()
            return
        except KeyboardInterrupt:
            continue
    child.wait()


@dataclass
class _Ended:
    status: int
    objects: list  # JSON objects on standard output, in turn
    stopped: bool = False


def _objects(text):
    out = []
    decoder = json.JSONDecoder()
    at = 0
    while (begin := text.find("{", at)) >= 0:
        try:
            one, at = decoder.raw_decode(text, begin)
            out.append(one)
        except ValueError:
            break
    return out


def execute(arguments, progress=False, form=("--json",)):
    """The program with these arguments and --json (form). Its progress goes through a terminal of our own, as there it says most."""
    teller = Teller(progress)
    ours, theirs = pty.openpty()
    try:
        # A process group of its own: Ctrl-C in a terminal comes to Python alone, which passes it on.
        child = subprocess.Popen([installation.program(), *arguments, *form], stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=theirs, process_group=0)
    except BaseException:
        os.close(ours)
        raise
    finally:
        os.close(theirs)
    told = []
    follower = threading.Thread(target=lambda: told.append(_follow(ours, teller, child)), daemon=True)
    follower.start()
    printed = []
    reader = threading.Thread(target=lambda: printed.append(child.stdout.read()), daemon=True)
    reader.start()
    stopped = False
    try:
        child.wait()
    except KeyboardInterrupt:
        stopped = True
        _stop(child)
    except BaseException:
        _stop(child)
        raise
    finally:
        if child.poll() is not None:
            reader.join()
            follower.join(2.0)
            teller.end()
        child.stdout.close()
        os.close(ours)
    if told and told[0] is not None:
        raise told[0]
    return _Ended(child.returncode, _objects(printed[0].decode(errors="replace")), stopped)


def _remarks(summary):
    """Why a result is not usable: remarks of a run, reasons of laws that were not determined."""
    laws = [f"{kind}: {law['status']}: {law['reason']}" for kind, law in (summary.get("laws") or {}).items()
            if isinstance(law, dict) and law.get("status") != "good" and law.get("reason")] if isinstance(summary.get("laws"), dict) else []
    return [*(summary.get("remarks") or []), *laws]


def raise_for(ended, given=None, paths=None, directory=None):
    """The exception for a status that is not good. given, paths: of scene_file()."""
    if ended.status == 130 or (ended.stopped and ended.status != 0):
        raise Interrupted("stopped; what was computed is saved" +
                          (f" in {directory}: run(..., resume=True) goes on" if directory else ""), directory)
    errors = next((o["errors"] for o in reversed(ended.objects) if "errors" in o), None)
    if errors is None:
        how = f"by signal {-ended.status}" if ended.status < 0 else f"with status {ended.status}"
        if ended.status == 3:
            raise UnusableResult([f"not usable: {r}" for o in ended.objects[:1] for r in _remarks(o)]
                                 or ["ran, but the result is not usable as it is"])
        kind = {InputError.status: InputError, IoError.status: IoError}.get(ended.status, SoftgrainError)
        error = kind([f"the program ended {how}" + (f"; see {directory}/log.txt" if directory else "")])
        error.status = ended.status
        raise error
    error = error_of(ended.status, errors)
    if paths is not None:
        error = type(error)(tuple(_of_dict(m, given, paths) for m in error.mistakes))
    raise error


def _of_dict(mistake, given, paths):
    """A mistake in a scene that was a dict: its place there."""
    message = mistake.message.replace(f"{given}:1 ", "").replace(given, "<scene>")
    if mistake.file != given:
        return replace(mistake, message=message)
    path = paths.get(mistake.line)
    if not paths:  # of a text: its line says where
        return replace(mistake, message=message, file="<scene>")
    return replace(mistake, message=message, file="<scene>", path=path if path and mistake.key in (None, _last(path)) else
                   f"{path}.{mistake.key}" if path and mistake.key else mistake.key)


def _last(path):
    return re.sub(r"\[\d+\]$", "", path.rpartition(".")[2])


def option(name, value):
    """An option of the command line, none for None."""
    return [] if value is None else [name, os.fspath(value) if isinstance(value, os.PathLike) else str(value)]


def require_unusable(word):
    """Refuses what `unusable` cannot be, before any work."""
    if word not in ("raise", "return"):
        raise InputError([f'unusable = "{word}": must be "raise" or "return"'])


def outcome(ended, directory, unusable, make, given=None, paths=None):
    """What a command that writes a run directory gives: make(directory). unusable: "raise" or "return"."""
    if ended.status == 0:
        return make(directory)
    try:
        raise_for(ended, given, paths, directory)
    except UnusableResult as e:
        if (directory / "summary.json").exists():
            e.run = make(directory)
        if unusable == "raise" or e.run is None:
            raise
        return e.run


def run(scene, *, set=None, out=None, law=None, threads=None, seed=None, resume=False,  # pylint: disable=redefined-builtin
        bands=None, progress=True, unusable="raise", options=()):
    """Runs a scene and gives what came out, a Run.

    scene: a file, a dict of its content (numbers, texts with units, lists, dicts; numpy arrays are lists), or its text (TOML of more
    than one line). Paths in a dict or text are relative to the working directory.
    set: changes to it, {"packing.count": 4} or {"packing": {"count": 4}}.
    out: run directory; results/NAME of the file, results/KIND of a dict. One that another run has written is written anew, unless
    resume, which goes on there (same scene, seed and law).
    law: of macro scenes, a file, a run that measured it, a Calibration or a Law; bands: draws of it for error bars. threads: all cores unless given; results do not depend on it. options: further ones of the command
    line, ["--law-cache", DIR].
    progress: True shows it, False does not, and a function gets (share, text) as it goes: share from 0 to 1 of what the run is at, None
    with a line of its log. It is called from another thread.
    unusable: "raise" UnusableResult for a result that must not be used as it is (its attribute `run` has what was written), or "return" it.

    Raises InputError before anything runs, with all mistakes at once; IoError; Interrupted (a KeyboardInterrupt) after Ctrl-C, once
    what was computed is saved."""
    require_unusable(unusable)
    directory = Path(out) if out is not None else run_directory(scene, set)
    with scene_file(scene) as (file, paths):
        arguments = ["run", file, "--out", str(directory), *settings(set), *option("--law", law),
                     *option("--threads", threads), *option("--seed", seed), *option("--bands", bands),
                     *(["--resume"] if resume else []), *map(str, options)]
        ended = execute(arguments, progress)
        return outcome(ended, directory, unusable, Run, file, paths)


class Findings(Drawn):
    """What check() found out. findings["time_step"]: a fact by name; kind; warnings: what may make a result wrong; core_seconds: time that a run would
    take on one core, None where it is not known."""

    def __init__(self, facts):
        self.facts = {k: v for k, v in facts.items() if k not in ("status", "warnings", "lines")}
        self.warnings = tuple(facts.get("warnings", ()))
        self.lines = tuple(facts.get("lines", ()))

    kind = property(lambda self: self.facts.get("kind"))
    core_seconds = property(lambda self: self.facts.get("core_seconds"))

    def __getitem__(self, name):
        return self.facts[name]

    def __contains__(self, name):
        return name in self.facts

    def __iter__(self):
        return iter(self.facts)

    def __len__(self):
        return len(self.facts)

    def __str__(self):
        return "\n".join([*self.lines, *(f"warning: {w}" for w in self.warnings)])

    def __repr__(self):
        cost = "" if self.core_seconds is None else f", about {self.core_seconds:.3g} s on one core"
        return f"<check of {self.kind or self.facts.get('what', 'a file')}: {counted(len(self.warnings), 'warning')}{cost}>"

    def _repr_html_(self):
        return f"<pre>{html.escape(str(self))}</pre>{self._image()}"

    def figure(self):
        """Where the time of a run goes, as a matplotlib figure; None where that is not known."""
        from softgrain.figures import new_figure
        parts = self.facts.get("core_seconds_parts")
        if not parts:
            return None
        names = sorted(parts, key=parts.get)
        figure, axes = new_figure(height=0.9 + 0.35 * len(names))
        axes.barh(names, [parts[n] for n in names])
        axes.set_xlabel("time on one core [s]")
        return figure


def check(scene, *, set=None, law=None):  # pylint: disable=redefined-builtin
    """What follows from a scene, a law, a result or a run directory, without running it: Findings. Raises InputError with all mistakes at
    once, IoError."""
    with scene_file(scene) as (file, paths):
        ended = execute(["check", file, *settings(set), *option("--law", law)])
        if ended.status != 0:
            raise_for(ended, file, paths)
        facts = ended.objects[0]
        if paths is not None:
            for key in ("lines", "warnings"):
                facts[key] = [text.replace(file, "<scene>") for text in facts.get(key, [])]
        return Findings(facts)
