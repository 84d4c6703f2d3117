"""Runs a target under atheris (libFuzzer), or over given files without it."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

# Unbounded growth would stop the machine before it stops the run.
# Long inputs from the start: missing bytes decode to zeros, which make poor meshes.
LIMITS = ["-rss_limit_mb=4096", "-timeout=30", "-len_control=0"]


def instrument(*modules: str) -> None:
    """Import modules so that atheris sees which of their lines run, if it is installed."""
    if has_atheris():
        with _atheris().instrument_imports(include=[m.split(".")[0] for m in modules]):
            for module in modules:
                importlib.import_module(module)


def one_line(error: Exception, *words: str) -> None:
    """Assert that the error is one line that contains one of the words."""
    text = str(error)
    assert len(text.splitlines()) == 1, f"not one line: {error!r}"
    assert any(word in text for word in words), f"names nothing: {error!r}"


def has_atheris() -> bool:
    """Whether atheris is here: it has wheels for Linux on x86-64 alone."""
    return importlib.util.find_spec("atheris") is not None


def run(target: Callable[[bytes], None], seeds: Iterable[bytes]) -> None:
    """Fuzz with libFuzzer's arguments from the command line; files named there are replayed."""
    files = [Path(argument) for argument in sys.argv[1:] if Path(argument).is_file()]
    for file in files:
        target(file.read_bytes())
    if files:
        print(f"{len(files)} inputs: no law broken")
        return
    if not has_atheris():
        sys.exit("atheris is not installed: it has no wheel for this machine")
    with tempfile.TemporaryDirectory() as folder:
        for i, seed in enumerate(seeds):
            (Path(folder) / f"seed{i:03}").write_bytes(seed)
        # New inputs go to the first folder: the user's own, if there is one.
        own = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
        options = [argument for argument in sys.argv[1:] if argument.startswith("-")]
        _atheris().Setup([sys.argv[0], *LIMITS, *options, *own, folder], target)
        _atheris().Fuzz()


def _atheris() -> Any:
    return importlib.import_module("atheris")
