"""Trust in files that hold pickles, which can run any code when they are loaded.

The hashes of the pickles that this machine's user wrote are kept in the user's state folder,
`$XDG_STATE_HOME/fgenv/trusted` (default `~/.local/state`). Other pickles need explicit trust.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from fgenv.saving import atomic, save_text

MAX_HASHES = 10_000
MAX_SIZE = 1 << 31  # bytes of a file

_all_files: ContextVar[bool] = ContextVar("trusted", default=False)


class TrustError(ValueError):
    """A file with a pickle that this machine did not write."""


@contextmanager
def trusting(trust: bool = True) -> Iterator[None]:
    """Trust files of any origin within a context; an outer context's trust stays."""
    token = _all_files.set(trust or _all_files.get())
    try:
        yield
    finally:
        _all_files.reset(token)


def read(path: Path) -> bytes:
    """Return the content of a file that holds a pickle, without unpickling it.

    Raises:
        ValueError: not a regular file, or too large.
        OSError: the file cannot be read.
    """
    if path.exists() and not path.is_file():
        raise ValueError(f"policy: got {path}, expected a regular file")
    size = path.stat().st_size
    if size > MAX_SIZE:
        raise ValueError(f"policy: {path}: got {size:,} bytes, expected at most {MAX_SIZE:,}")
    return path.read_bytes()


def check(path: Path, content: bytes, trust: bool = False) -> None:
    """Raise TrustError unless this machine wrote the content, or `trust` or a context allows it."""
    if not (trust or _all_files.get() or _hash(content) in _hashes()):
        raise TrustError(
            f"policy: {path} holds a pickle, which can run any code, and was not written by fgenv"
            " on this machine; if you trust its origin, use --trust (trust=True in Python)"
        )


@contextmanager
def written(path: Path) -> Iterator[Path]:
    """Write a file atomically as `saving.atomic` does, and trust it from then on."""
    with atomic(path) as partial:
        yield partial
        remember(partial.read_bytes())


def remember(content: bytes) -> None:
    """Trust files with this content. Without a writable state folder they are not trusted."""
    hashes = [*_hashes(), _hash(content)]
    path = _store()
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        save_text(path, "".join(f"{line}\n" for line in dict.fromkeys(hashes[-MAX_HASHES:])))
    except OSError:
        pass


def _store() -> Path:
    """File of the hashes. XDG requires an absolute path, and others are ignored."""
    state = os.environ.get("XDG_STATE_HOME", "")
    folder = Path(state) if os.path.isabs(state) else Path.home() / ".local" / "state"
    return folder / "fgenv" / "trusted"


def _hashes() -> list[str]:
    try:
        return _store().read_text(encoding="ascii").split()
    except (OSError, UnicodeDecodeError):
        return []


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
