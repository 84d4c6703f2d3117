"""Numbers on the command line."""

from __future__ import annotations


def numbers(text: str) -> list[float]:
    """Return numbers with commas between, of --q.

    Raises:
        ValueError: others.
    """
    try:
        return [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        raise ValueError(f"--q: got {text!r}, expected numbers with commas between") from None
