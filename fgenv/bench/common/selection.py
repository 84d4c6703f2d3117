"""Selection of benchmark cases by parts of their names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar


class Named(Protocol):
    """A case with a name."""

    @property
    def name(self) -> str:
        """Name of the case."""


Case = TypeVar("Case", bound=Named)


def split_names(text: str) -> tuple[str, ...]:
    """Return the names in a list with commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def select(cases: Iterable[Case], words: Sequence[str], option: str) -> tuple[Case, ...]:
    """Return the cases with at least one of the words in their names, in their order.

    Raises:
        ValueError: no case matches; the error names the option.
    """
    known = tuple(cases)
    selected = tuple(case for case in known if any(word in case.name for word in words))
    if not selected:
        names = "; ".join(case.name for case in known)
        raise ValueError(f"{option}: got {', '.join(words)!r}, expected a part of: {names}")
    return selected
