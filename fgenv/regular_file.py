"""Reading of files from others: only regular files, up to a size."""

from __future__ import annotations

import os
import stat
from pathlib import Path


def read_regular(path: Path, expected: str, max_bytes: int) -> bytes:
    """Content of a regular file: no folder, pipe or device, which could block or never end.

    Args:
        expected: kind of the file, for messages, e.g. "a mesh file".

    Raises:
        FileNotFoundError: no such file, or a folder.
        ValueError: a pipe or a device, too large, or a path that cannot be read.
    """
    check_regular(path, expected, max_bytes)
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(descriptor)  # the file may have changed
        _check(path, status, expected, max_bytes)
        return file.read(status.st_size)


def check_regular(path: Path, expected: str, max_bytes: int) -> None:
    """Raise the errors of `read_regular` without opening the file."""
    try:
        status = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        raise FileNotFoundError(f"path: {path} does not exist, expected {expected}") from None
    except (OSError, ValueError) as error:  # a loop of links, no permission, a null character
        reason = getattr(error, "strerror", None) or str(error)
        raise ValueError(f"path: {path} cannot be read ({reason}), expected {expected}") from None
    _check(path, status, expected, max_bytes)


def _check(path: Path, status: os.stat_result, expected: str, max_bytes: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise FileNotFoundError(f"path: {path} is a folder, expected {expected}")
    if not stat.S_ISREG(status.st_mode):
        raise ValueError(f"path: {path} is a device or pipe, expected {expected}")
    if status.st_size > max_bytes:
        size, most = f"{status.st_size:,}", f"{max_bytes:,}"
        raise ValueError(f"path: {path} has {size} bytes, expected {expected} of at most {most}")
