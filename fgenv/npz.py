"""Bounded reading of `.npz` files: every size is checked before a byte is inflated.

Files from others can claim any size: 2 MB of a zip inflate to 2 GB. The reader accepts what
`numpy.savez` writes, without pickles: stored or deflated entries whose size is that of their
NumPy header.
"""

from __future__ import annotations

import os
import stat
import struct
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

LIMIT = 1 << 29  # bytes of all arrays of a file
MAX_ENTRIES = 1000
END = struct.Struct("<4s4H2IH")  # the end record of a zip without a comment
MAX_DIRECTORY = 1 << 20  # bytes


class NpzError(ValueError):
    """A file that is no bounded .npz file."""


@dataclass(frozen=True)
class Header:
    """Shape and type of an array in a file."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def size(self) -> int:
        """Bytes of the array."""
        size = self.dtype.itemsize
        for extent in self.shape:  # Python's integers do not overflow
            size *= extent
        return size


class NpzFile:
    """An open file; nothing is inflated before its header is checked."""

    def __init__(self, archive: zipfile.ZipFile, limit: int) -> None:
        entries = archive.infolist()
        names = [entry.filename for entry in entries]
        if len(set(names)) < len(names) or len(names) > MAX_ENTRIES:
            raise NpzError("got repeated or too many entries")
        self._archive, self._limit = archive, limit

    @cached_property
    def headers(self) -> dict[str, Header]:
        """Headers of all arrays by name; NpzError if one is invalid, or all exceed the limit."""
        entries = self._archive.infolist()
        headers = {e.filename.removesuffix(".npy"): self._header(e) for e in entries}
        self._check_size(sum(header.size for header in headers.values()))
        return headers

    def read(self, name: str) -> NDArray[Any]:
        """Return an array; raise KeyError for an unknown name, NpzError as `headers`."""
        return self._content(name, self.headers[name])

    def text(self, name: str) -> str:
        """Return a text; raise KeyError for an unknown name, NpzError for another array."""
        header = self._header(self._archive.getinfo(f"{name}.npy"))
        if header.shape != () or header.dtype.kind != "U":
            raise NpzError(f"{name}: got an array, expected a text")
        self._check_size(header.size)
        return str(self._content(name, header)[()]) if header.dtype.itemsize else ""

    def _check_size(self, size: int) -> None:
        if size > self._limit:
            raise NpzError(f"got {size:,} bytes of arrays, expected at most {self._limit:,}")

    def _content(self, name: str, header: Header) -> NDArray[Any]:
        with self._archive.open(f"{name}.npy") as file:
            read_header(file)
            content = file.read(header.size)
            if len(content) != header.size or file.read(1):
                raise NpzError(f"{name}: got another size than that of its header")
        return np.frombuffer(bytearray(content), header.dtype).reshape(header.shape)

    def _header(self, entry: zipfile.ZipInfo) -> Header:
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise NpzError(f"{entry.filename}: got an unknown compression")
        if entry.flag_bits & 1 or not entry.filename.endswith(".npy"):
            raise NpzError(f"{entry.filename}: got an encrypted file, or another one than .npy")
        with self._archive.open(entry) as file:
            header, length = read_header(file)
        if entry.file_size != length + header.size:
            raise NpzError(f"{entry.filename}: got another size than that of its header")
        return header


@contextmanager
def open_npz(path: str | Path, limit: int = LIMIT) -> Iterator[NpzFile]:
    """Open a file whose arrays have at most `limit` bytes in all.

    Raises:
        NpzError: not a regular file, no .npz file, or larger.
        OSError: the file cannot be read.
        zipfile.BadZipFile, zlib.error: a damaged zip.
    """
    if not stat.S_ISREG(os.stat(path).st_mode):
        if os.path.isdir(path):
            raise IsADirectoryError(21, os.strerror(21), str(path))
        raise NpzError("got a device or a pipe, expected a regular file")
    with open(path, "rb") as file:
        check_directory(file, limit)
        with zipfile.ZipFile(file) as archive:
            yield NpzFile(archive, limit)


def check_directory(file: IO[bytes], limit: int) -> None:
    """Raise NpzError for a zip whose table of entries exceeds what `numpy.savez` writes."""
    size = file.seek(0, os.SEEK_END)
    if not END.size <= size <= limit + MAX_DIRECTORY:
        raise NpzError(f"got {size:,} bytes, expected {END.size} to {limit + MAX_DIRECTORY:,}")
    begin = max(0, size - END.size - 20)  # 20 bytes: the locator of a 64-bit table
    file.seek(begin)
    tail = file.read()
    signature, *_, length, _, comment = END.unpack(tail[-END.size :])
    if signature != b"PK\5\6" or comment or length > MAX_DIRECTORY or b"PK\6\7" in tail[:4]:
        raise NpzError("got no zip, or one with another table than that of numpy.savez")
    file.seek(0)


def read_header(file: IO[bytes]) -> tuple[Header, int]:
    """Return an array's header and its length in bytes.

    Raises:
        NpzError: an array of Python objects, in Fortran order, or of another version.
        ValueError: a damaged header.
    """
    if npy.read_magic(file) != (1, 0):
        raise NpzError("got another version of NumPy's format, expected 1.0")
    shape, fortran, dtype = npy.read_array_header_1_0(file)
    if dtype.hasobject or fortran or any(extent < 0 for extent in shape):
        raise NpzError("got an array of objects or in Fortran order, expected numbers")
    return Header(shape, dtype), file.tell()
