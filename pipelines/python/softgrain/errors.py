"""What goes wrong, as exceptions that say where and what: one per exit status of the program."""
import json
from dataclasses import dataclass, fields


@dataclass(frozen=True)
class Mistake:
    """One mistake of a scene, a card or an option. What a message does not say is None."""

    message: str
    file: str | None = None  # "<scene>" for one that was given as a dict
    line: int | None = None  # of that file; of a dict as TOML
    key: str | None = None  # "shell_raduis"
    path: str | None = None  # "packing.shell_raduis", of a scene that was given as a dict
    table: str | None = None  # "packing", where the message says it
    value: str | None = None  # as it stands there
    allowed: str | None = None  # "must be above 0"
    nearest: str | None = None  # the word that was probably meant
    setting: str | None = None  # the key of `set` that it came from

    def __str__(self):
        place = self.path or (f"{self.file}:{self.line}" if self.file and self.line else self.file)
        return f"{place}: {self.message}" if place and not self.message.startswith(f"{place}:") else self.message


class SoftgrainError(Exception):
    """Base of all errors here. mistakes: every one that was found, each with file, line, key, allowed values and nearest word as
    far as they are known."""

    status = None  # exit status of the program, where it said one: 2 bad input, 3 not usable, 4 file trouble

    def __init__(self, mistakes):
        self.mistakes = tuple(Mistake(m) if isinstance(m, str) else m for m in mistakes)
        super().__init__("\n".join(map(str, self.mistakes)))

    def __reduce__(self):  # comes whole out of another process
        return type(self), (self.mistakes,), self.__dict__

    def _first(self, name):
        return getattr(self.mistakes[0], name) if self.mistakes else None

    file = property(lambda self: self._first("file"), doc="Of the first mistake.")
    line = property(lambda self: self._first("line"), doc="Of the first mistake.")
    key = property(lambda self: self._first("key"), doc="Of the first mistake.")
    allowed = property(lambda self: self._first("allowed"), doc="Of the first mistake.")
    nearest = property(lambda self: self._first("nearest"), doc="Of the first mistake.")


class InputError(SoftgrainError, ValueError):
    """A scene, card or option is wrong: nothing was run."""

    status = 2


class UnusableResult(SoftgrainError):
    """It ran, but the result must not be used as it is. run: what was written, None where there is nothing."""

    status = 3
    run = None


class IoError(SoftgrainError, OSError):
    """A file could not be read or written, or its content is damaged."""

    status = 4

    def __str__(self):  # that of OSError is about errno
        return "\n".join(map(str, self.mistakes))


class Interrupted(KeyboardInterrupt):
    """A run was stopped: what was computed is saved, and run(..., resume=True) goes on. directory: where."""

    status = 130

    def __init__(self, message, directory=None):
        super().__init__(message)
        self.directory = directory

    def __reduce__(self):
        return type(self), (str(self), self.directory)


# Their names before version 0.3.
BadInput, NotUsable, FileTrouble = InputError, UnusableResult, IoError

_OF_STATUS = {2: InputError, 3: UnusableResult, 4: IoError}
_KNOWN = {f.name for f in fields(Mistake)}


def mistakes_of(objects):
    """Error objects of the program as mistakes."""
    return tuple(Mistake(**{k: v for k, v in one.items() if k in _KNOWN}) for one in objects)


def error_of(status, errors):
    """The exception of an exit status. errors: objects with "message", "file", "line"..., or their JSON text."""
    objects = json.loads(errors) if isinstance(errors, str) else errors
    return _OF_STATUS.get(status, SoftgrainError)(mistakes_of(objects))
