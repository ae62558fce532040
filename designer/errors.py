"""All exceptions that this package raises on purpose.

::

    DesignerError
    ├── InputError          the user's files or arguments are wrong (exit status 2)
    │   └── WrongValueError      a value made in Python is wrong; also a ValueError
    ├── OutputError         the results cannot be written where asked (exit status 2)
    ├── NothingToExportError no cables or ropes serve the study (exit status 1)
    ├── MissingLibraryError the machine lacks what draws in space (exit status 2)
    ├── MissingRingError    a part of ours was left out of this installation (exit status 2)
    ├── PluginError         code of a plugin fails at work (exit status 2)
    └── EffectError         an effect that a plugin brought in fails at work (exit status 2)
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


class DesignerError(Exception):
    """Base of all errors whose message is meant for the user as it stands."""


def visible(text: str) -> str:
    """Return a text with a ``?`` for each letter that commands a terminal or shows as nothing."""
    blanks = "\n\u00a0\u2009\u202f"
    return "".join(letter if letter.isprintable() or letter in blanks else "?" for letter in text)


def one_line(text: object) -> str:
    """Return a text on one line, without control characters, cut short."""
    try:
        words = " ".join(str(text).split())
    except Exception:  # a stranger's exception may fail at telling what it is
        words = "an error without a readable message"
    return visible(words if len(words) <= 300 else words[:300] + "…")


def described(error: BaseException) -> str:
    """Return the kind of an error and what it says, on one line; a stranger's may be any text."""
    return ": ".join(filter(None, (one_line(type(error).__name__), one_line(error))))


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong in an input file.

    Parameters
    ----------
    file : str
        The file as the user named it.
    line : int or None
        Line number from 1, where known.
    field : str
        Path into the document, such as ``robot.anchors[2]``; empty for the whole file.
    problem : str
        What was found.
    expected : str
        What was expected instead; may be empty.
    """

    file: str
    line: int | None
    field: str
    problem: str
    expected: str = ""

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        problem = f"{self.field}: {self.problem}" if self.field else self.problem
        hint = f" (expected {self.expected})" if self.expected else ""
        return visible(" ".join(f"{place}: {problem}{hint}".split()))


class InputError(DesignerError):
    """The input is wrong; carries every fault that was found, one line each."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))

    @classmethod
    def at(
        cls, file: object, problem: str, expected: str = "", *, line: int | None = None
    ) -> InputError:
        """Return the error of one fault in a file, of all of it or in a line, or in an option."""
        return cls([Fault(str(file), line, "", problem, expected)])


class WrongValueError(InputError, ValueError):
    """A value made in Python is refused; its fault names the class as file, and the field."""

    def __init__(self, kind: str, field: str, sentence: str, expected: str = "") -> None:
        problem = sentence.removeprefix(field).lstrip(": ")
        super().__init__([Fault(kind, None, field, problem, expected)])
        self.args = (f"{sentence} (expected {expected})" if expected else sentence,)


class OutputError(DesignerError):
    """The output folder cannot be used."""


class NothingToExportError(DesignerError):
    """The study has not come to the cables or ropes that a format needs."""


class MissingLibraryError(DesignerError):
    """A library of the operating system is missing; the message names its package."""


class MissingRingError(DesignerError):
    """A capability of ours was left out of this installation; the message names it."""


class PluginError(DesignerError):
    """Code of a plugin fails at work; says whose it is, and what happened."""


class EffectError(DesignerError):
    """An effect that a plugin brought in fails at work; says whose it is, and what happened."""

    def __init__(self, effect_id: str, message: str) -> None:
        super().__init__(message)
        self.effect_id = effect_id
