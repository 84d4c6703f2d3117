"""Consoles of commands; `fgenv --quiet` silences what is beside the result."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

_quiet = False  # of this process; set by the options of `fgenv` before each command


def set_quiet(quiet: bool) -> None:
    """Print only results on stdout and errors on stderr, or also progress and tables on stderr."""
    global _quiet
    _quiet = quiet


def is_quiet() -> bool:
    """Return whether progress and tables on stderr are silenced."""
    return _quiet


def console_of(as_json: bool) -> Console:
    """Return the console of tables: stdout, or stderr beside a JSON document."""
    from rich.console import Console

    return Console(stderr=as_json, highlight=False, quiet=as_json and _quiet)
