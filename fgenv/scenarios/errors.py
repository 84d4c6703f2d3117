"""What is wrong with a scenario: where, why, and the remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

Location = tuple[str | int, ...]


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong.

    Attributes:
        text: what came and what is expected.
        remedy: what to do.
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
        return f"{place}{name}{self.text}" + (f"; {self.remedy}" if self.remedy else "")

    def at(self, line: int | None) -> Problem:
        """The same, in a line."""
        return replace(self, line=line)


class ScenarioError(ValueError):
    """A scenario that cannot be used, and all that is wrong with it."""

    def __init__(self, source: str | Path, problems: Iterable[Problem]) -> None:
        self.source, self.problems = source, tuple(problems)
        lines = [str(problem) for problem in self.problems]
        many = f"{len(lines)} problems:\n  " if len(lines) > 1 else ""
        super().__init__(f"{source}: {many}" + ".\n  ".join(lines))

    def __reduce__(self) -> tuple[type, tuple[str | Path, tuple[Problem, ...]]]:
        return type(self), (self.source, self.problems)


def path_text(location: Sequence[str | int]) -> str:
    """robots[3].start for ('robots', 3, 'start')."""
    text = ""
    for step in location:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else str(step)
    return text


def near(word: object, known: Iterable[str]) -> str:
    """'did you mean ...?', or what is known."""
    names = list(known)
    close = difflib.get_close_matches(str(word), names, n=3, cutoff=0.6)
    if close:
        return f"did you mean {' or '.join(map(repr, close))}?"
    shown = ", ".join(names[:30]) + (", ..." if len(names) > 30 else "")
    return f"expected one of: {shown}" if names else "there are none"
