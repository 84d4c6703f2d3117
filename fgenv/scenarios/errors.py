"""Errors of scenarios: the place, the fault and the remedy."""

from __future__ import annotations

import difflib
import reprlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fgenv.printable import printable

Location = tuple[str | int, ...]


@dataclass(frozen=True)
class Problem:
    """A problem of a scenario.

    Attributes:
        text: the fault, with the value received and the value expected.
        remedy: how to fix it.
        where: the place in the file, such as robots[3].start.
        line: of the file, from 1.
    """

    text: str
    remedy: str = ""
    where: str = ""
    line: int | None = None

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line else ""
        name = f"{self.where}: " if self.where else ""
        return printable(f"{place}{name}{self.text}" + (f"; {self.remedy}" if self.remedy else ""))


class ScenarioError(ValueError):
    """A scenario that cannot be used; lists all its problems."""

    def __init__(self, source: str | Path, problems: Iterable[Problem]) -> None:
        self.source, self.problems = source, tuple(problems)
        lines = [str(problem) for problem in self.problems]
        many = f"{len(lines)} problems:\n  " if len(lines) > 1 else ""
        super().__init__(f"{source}: {many}" + ".\n  ".join(lines))

    def __reduce__(self) -> tuple[type, tuple[str | Path, tuple[Problem, ...]]]:
        return type(self), (self.source, self.problems)


class UnknownOverrideError(ScenarioError):
    """Overrides that a scenario does not have; the names are those of `problems`."""


_SHORT = reprlib.Repr()
_SHORT.maxlevel, _SHORT.maxstring, _SHORT.maxother, _SHORT.maxlong = 3, 60, 60, 60


def short(value: Any) -> str:
    """The representation of a value, cut to 60 characters; the time does not depend on its size."""
    return cut(_SHORT.repr(value), 60)


def cut(text: str, length: int = 100) -> str:
    """A text in one line, of at most this length."""
    text = " ".join(text[: 2 * length].split())
    return text if len(text) <= length else text[: length - 3] + "..."


def path_text(location: Sequence[str | int]) -> str:
    """robots[3].start for ('robots', 3, 'start')."""
    text = ""
    for step in location:
        name = cut(str(step), 60)
        text += f"[{name}]" if isinstance(step, int) else f".{name}" if text else name
    return text


def near(word: object, known: Iterable[str]) -> str:
    """A remedy: 'did you mean ...?', or the list of the known names."""
    names = list(known)
    close = difflib.get_close_matches(cut(str(word), 200), names, n=3, cutoff=0.6)
    if close:
        return f"did you mean {' or '.join(map(repr, close))}?"
    shown = ", ".join(names[:30]) + (", ..." if len(names) > 30 else "")
    return f"expected one of: {shown}" if names else "there are none"
