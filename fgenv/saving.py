"""Atomic saving: a file is complete and on disk, or the previous one stays.

The new content goes to a temporary file in the same folder, which replaces the target at the end.
Each temporary file has a name of its own, so that processes can save to one path at the same time.
A lock marks temporary files in use; the next save removes those that a killed process left.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import re
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

STALE = 60.0  # seconds; younger temporary files may not be locked yet
NAME_LENGTH = 40  # characters of the target's name in that of a temporary file


@contextmanager
def atomic(path: str | Path) -> Iterator[Path]:
    """Replace a file at the end of a context with the temporary file that the context wrote.

    The temporary file exists and has the suffix of `path`. A symbolic link stays, and its target is
    replaced. The permissions of an existing file stay. A device or a pipe is written directly.

    Raises:
        OSError: the file cannot be written; the error has the name of `path`.
    """
    path = Path(path)
    target = Path(os.path.realpath(path))
    mode = _mode(target)
    if mode is not None and not stat.S_ISREG(mode):
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        yield path
        return
    if mode is not None and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    _remove_stale(target)
    partial = _temporary(target)
    try:
        number = os.open(partial, os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(path)) from None
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if mode is not None:
            os.fchmod(number, stat.S_IMODE(mode))
        yield partial
        _synchronize(partial)
        os.replace(partial, target)
        _synchronize(target.parent)
    finally:
        os.close(number)
        partial.unlink(missing_ok=True)


def save_bytes(path: str | Path, content: bytes) -> None:
    """Write a file atomically; see `atomic`."""
    with atomic(path) as partial:
        partial.write_bytes(content)


def save_text(path: str | Path, text: str) -> None:
    """Write a UTF-8 file atomically, with the line ends of the text; see `atomic`."""
    save_bytes(path, text.encode())


def _mode(target: Path) -> int | None:
    """Return type and permissions of a file, or None if it does not exist."""
    try:
        return target.stat().st_mode
    except FileNotFoundError:
        return None


def _temporary(target: Path) -> Path:
    name = f".{target.stem[:NAME_LENGTH]}.{secrets.token_hex(8)}.part{target.suffix}"
    return target.with_name(name)


def _remove_stale(target: Path) -> None:
    """Remove temporary files of the target that no process has locked."""
    stem, suffix = re.escape(target.stem[:NAME_LENGTH]), re.escape(target.suffix)
    name = re.compile(rf"\.{stem}\.[0-9a-f]{{16}}\.part{suffix}")
    with contextlib.suppress(OSError):
        for entry in os.scandir(target.parent):
            if name.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                _remove_unlocked(Path(entry.path))


def _remove_unlocked(partial: Path) -> None:
    """Remove an old temporary file unless it is in use."""
    with contextlib.suppress(OSError), open(partial, "rb") as file:
        if time.time() - os.fstat(file.fileno()).st_mtime > STALE:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            partial.unlink()


def _synchronize(path: Path) -> None:
    """Write a file's content, or a folder's entries, to the disk."""
    number = os.open(path, os.O_RDONLY)
    try:
        os.fsync(number)
    except OSError as error:  # some file systems have no synchronization of folders
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(number)
