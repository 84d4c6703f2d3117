"""Archives: the file format of records, plans and trained policies.

A NumPy `.npz` (a zip of arrays; `numpy.load` reads it), compressed:

    format    "fgenv KIND VERSION"
    id        SHA-256 of the other contents: 64 hexadecimal digits
    texts     by name
    arrays    by name, little-endian

The hash covers the format, then name, length and content of each text, then name, shape and bytes
of each array, in the order of the file.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from fgenv.file_kind import ARCHIVES, other_kind
from fgenv.npz import LIMIT, Header, open_npz
from fgenv.printable import printable
from fgenv.saving import atomic

Texts = Mapping[str, str]
Arrays = Mapping[str, NDArray[Any]]
T = TypeVar("T")


@dataclass(frozen=True)
class Archive:
    """A kind of file.

    Attributes:
        kind, version: the format.
        texts: names of the texts; all other entries are arrays.
        error: raised for invalid files.
        remedy: last part of the error's message.
        dtypes: of arrays by name; default float64.
        check: called with the texts and the headers of the arrays before an array is inflated.
    """

    kind: str
    version: int
    texts: tuple[str, ...]
    error: type[ValueError]
    remedy: str
    dtypes: Mapping[str, str] = field(default_factory=dict)
    check: Callable[[dict[str, str], dict[str, Header]], object] | None = None

    @property
    def format(self) -> str:
        """Format stored in the file."""
        return f"fgenv {self.kind} {self.version}"

    def id(self, texts: Texts, arrays: Arrays) -> str:
        """Return the hash of the contents."""
        digest = hashlib.sha256(f"{self.format}\n".encode())
        for name, text in texts.items():
            digest.update(f"{name} {len(text)}\n{text}\n".encode())
        for name, array in self._stored(arrays).items():
            digest.update(f"{name} {array.shape}\n".encode() + array.tobytes())
        return digest.hexdigest()

    def save(self, path: str | Path, texts: Texts, arrays: Arrays) -> None:
        """Write a file; an existing file is replaced atomically.

        Raises:
            ValueError: the name does not end in .npz.
            OSError: the file cannot be written.
        """
        path = Path(path)
        if path.suffix != ".npz":
            raise ValueError(f"{self.kind}: got {path}, expected a name that ends in .npz")
        head = {"format": self.format, "id": self.id(texts, arrays), **texts}
        stored = self._stored(arrays)
        size = sum(a.nbytes for a in stored.values()) + 4 * sum(map(len, head.values()))
        if size > LIMIT:
            raise ValueError(f"{self.kind}: got {size:,} bytes, expected at most {LIMIT:,}")
        with atomic(path) as partial, open(partial, "wb") as file:
            np.savez_compressed(file, **head, **stored)  # type: ignore[arg-type]

    def load(self, path: str | Path, read: Callable[[dict[str, str], dict[str, Any]], T]) -> T:
        """Return the result of `read` for the texts and arrays of a file with a valid hash.

        Raises:
            error: another kind of file or version, a damaged file, or an exception of `read`.
            FileNotFoundError: no such file.
        """
        try:
            with open_npz(path) as file:
                format, id = file.text("format"), file.text("id")
                if format.startswith(f"fgenv {self.kind} ") and format != self.format:
                    raise self.error(
                        f"{path}: got {format[:40]!r}, expected {self.format!r}; use the fgenv that"
                        f" wrote it, or {self.remedy}"
                    )
                texts = {name: file.text(name) for name in self.texts}
                rest = [name for name in file.headers if name not in ("format", "id", *texts)]
                if format == self.format and self.check is not None:
                    self.check(texts, {name: file.headers[name] for name in rest})
                arrays = self._stored({name: file.read(name) for name in rest})
            if format != self.format or id != self.id(texts, arrays):
                raise ValueError("id")
            return read(texts, arrays)
        except (FileNotFoundError, IsADirectoryError, PermissionError):
            raise
        except self.error as error:
            if str(path) in str(error):
                raise
            raise self.error(f"{path}: {printable(str(error))}") from error
        except Exception as error:  # zip, zlib, NumPy, JSON and pydantic each have their own
            other = self.kind in ARCHIVES and other_kind(path, ARCHIVES[self.kind])
            message = other or f"is damaged, or no {self.kind}; {self.remedy}"
            raise self.error(f"{path}: {message}") from error

    def _stored(self, arrays: Arrays) -> dict[str, NDArray[Any]]:
        """Arrays with the dtypes of the file."""
        return {
            name: np.ascontiguousarray(array, dtype=self.dtypes.get(name, "<f8"))
            for name, array in arrays.items()
        }
