"""Numbers in the lines of text formats, parsed by NumPy at once."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Ints

from .content import MeshSource

CHUNK = 32 << 20  # bytes of text split at once, which bounds the memory
# A number that no file has marks the end of each line, which shows how many numbers the line has.
END_FLOAT, END_INT = 1.5e300, -(2**62 - 1)


def text_chunks(source: MeshSource, data: bytes | None = None) -> Iterator[tuple[int, list[bytes]]]:
    """Lines of a text in chunks, with the number of the first line (from 1).

    Args:
        data: replaces the content of the source.
    """
    data = source.data if data is None else data
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")  # as old Macintosh programs write
    begin = 3 if data.startswith(b"\xef\xbb\xbf") else 0  # the mark of UTF-8
    number = 1
    while begin < len(data):
        source.progress(begin / len(data))
        end = data.find(b"\n", min(begin + CHUNK, len(data)) - 1)
        end = len(data) if end < 0 else end + 1
        lines = data[begin:end].split(b"\n")
        if end < len(data) or not lines[-1]:
            lines.pop()  # it is empty, or the chunk ends with it
        yield number, lines
        number += len(lines)
        begin = end


class BadNumberError(ValueError):
    """A line with something else than numbers."""

    def __init__(self, index: int, token: bytes) -> None:
        self.index = index
        self.token = token
        super().__init__(index, token)


def numbers(lines: Sequence[bytes], dtype: Any = np.float64) -> tuple[NDArray[Any], Ints]:
    """All numbers of lines, and how many each line has.

    Raises:
        BadNumberError: with the index of the line and its first other word.
    """
    if not lines:
        return np.empty(0, dtype=dtype), np.empty(0, dtype=np.int64)
    if np.dtype(dtype) == np.float64 and (table := _table(lines)) is not None:
        return table.ravel(), np.full(len(table), table.shape[1])
    end = END_FLOAT if np.dtype(dtype) == np.float64 else END_INT
    text = f" {end!r} ".encode()
    values = parse(text.join([*lines, b""]), dtype)
    ends = np.flatnonzero(values == end) if values is not None else np.empty(0, dtype=np.int64)
    if values is None or len(ends) != len(lines):
        raise BadNumberError(*_first_bad(lines, dtype))
    return np.delete(values, ends), np.diff(ends, prepend=-1) - 1


def _table(lines: Sequence[bytes]) -> NDArray[np.float64] | None:
    """The numbers of lines that all have the same count; None if they don't."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # no lines
        try:
            table = np.loadtxt(lines, dtype=np.float64, comments=None, ndmin=2)
        except ValueError:
            return None
    return table if len(table) == len(lines) and table.shape[1] > 0 else None


def parse(text: bytes, dtype: Any) -> NDArray[Any] | None:
    """Numbers separated by white space; None if there is anything else."""
    if not text.strip():
        return np.empty(0, dtype=dtype)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # of older versions of NumPy
        try:
            return np.fromstring(text, dtype=dtype, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def _first_bad(lines: Sequence[bytes], dtype: Any) -> tuple[int, bytes]:
    for i, line in enumerate(lines):
        for word in line.split():
            if parse(word, dtype) is None:
                return i, word
    return 0, lines[0] if lines else b""


def shown(word: bytes) -> str:
    """A word of a file for a message: quoted, printable, short."""
    text = word.decode("utf-8", "replace")
    return repr(text if len(text) <= 20 else text[:20] + "...")


def check_finite(
    source: MeshSource, vertices: NDArray[np.float64], line: Callable[[int], int]
) -> None:
    """Raise the error of the first vertex that is not finite; `line` gives its line."""
    if (bad := np.flatnonzero(~np.isfinite(vertices).all(axis=1))).size:
        row = vertices[bad[0]]
        value = row[~np.isfinite(row)][0]
        received = f"a vertex with the coordinate {value}"
        source.fail(received, "finite numbers", line=line(int(bad[0])))


def fail_number(source: MeshSource, error: BadNumberError, line: int) -> NoReturn:
    """Raise the error of a line with something else than numbers."""
    source.fail(shown(error.token), "a number", line=line)
