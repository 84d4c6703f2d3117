"""Archives: the one form of file in which records, plans and trained policies are kept.

A NumPy `.npz` (a zip of arrays; `numpy.load` reads it), compressed:

    format    "fgenv KIND VERSION"
    id        SHA-256 of all the rest: 64 hexadecimal digits
    texts     each under its name
    arrays    each under its name, little-endian

In the hash are the format, then name, length and text of each text, then name, shape and bytes of
each array, in the order of the file.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Texts = Mapping[str, str]
Arrays = Mapping[str, NDArray[Any]]
T = TypeVar("T")


@dataclass(frozen=True)
class Archive:
    """A kind of file.

    Attributes:
        kind, version: the format.
        texts: names of them; whatever else is in a file is an array.
        error: what is raised where a file cannot be used.
        remedy: what is told to do then.
        dtypes: of arrays by name; of others float64.
    """

    kind: str
    version: int
    texts: tuple[str, ...]
    error: type[ValueError]
    remedy: str
    dtypes: Mapping[str, str] = field(default_factory=dict)

    @property
    def format(self) -> str:
        """Told in the file."""
        return f"fgenv {self.kind} {self.version}"

    def id(self, texts: Texts, arrays: Arrays) -> str:
        """Hash of all that is in it."""
        found = hashlib.sha256(f"{self.format}\n".encode())
        for name, text in texts.items():
            found.update(f"{name} {len(text)}\n{text}\n".encode())
        for name, array in self._stored(arrays).items():
            found.update(f"{name} {array.shape}\n".encode() + array.tobytes())
        return found.hexdigest()

    def save(self, path: str | Path, texts: Texts, arrays: Arrays) -> None:
        """Write a file; one that is there is replaced in one go.

        Raises:
            ValueError: its name does not end in .npz.
            OSError: it cannot be written.
        """
        path = Path(path)
        if path.suffix != ".npz":
            raise ValueError(f"{self.kind}: got {path}, expected a name that ends in .npz")
        head = {"format": self.format, "id": self.id(texts, arrays), **texts}
        half = path.with_name(f".{path.name}.part")
        try:
            with open(half, "wb") as file:
                np.savez_compressed(file, **head, **self._stored(arrays))  # type: ignore[arg-type]
            os.replace(half, path)
        finally:
            half.unlink(missing_ok=True)

    def load(self, path: str | Path, read: Callable[[dict[str, str], dict[str, Any]], T]) -> T:
        """What `read` makes of the texts and arrays of a file, once their hash is found right.

        Raises:
            error: another kind of file or version, damaged, or what `read` raises.
            FileNotFoundError: no such file.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                said, id = str(file["format"]), str(file["id"])
                if said.startswith(f"fgenv {self.kind} ") and said != self.format:
                    told = f"is {said!r}, expected {self.format!r}; use the fgenv that wrote it"
                    raise self.error(f"{path}: {told}, or {self.remedy}")
                texts = {name: str(file[name]) for name in self.texts}
                others = [name for name in file.files if name not in ("format", "id", *texts)]
                arrays = self._stored({name: file[name] for name in others})
            if said != self.format or id != self.id(texts, arrays):
                raise ValueError("id")
            return read(texts, arrays)
        except (FileNotFoundError, IsADirectoryError, PermissionError, self.error):
            raise
        except Exception as error:  # zip, zlib, NumPy, JSON and pydantic each have their own
            told = f"is damaged, or no {self.kind}; {self.remedy}"
            raise self.error(f"{path}: {told}") from error

    def _stored(self, arrays: Arrays) -> dict[str, NDArray[Any]]:
        """As they are in a file."""
        return {
            name: np.ascontiguousarray(array, dtype=self.dtypes.get(name, "<f8"))
            for name, array in arrays.items()
        }
