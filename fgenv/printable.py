"""Text of files from others in messages."""

from __future__ import annotations


def printable(text: str) -> str:
    """The text with escapes in place of control characters, which could change a terminal."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
