"""The elements of a binary PLY file, in either order of bytes."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Ints

from .content import MeshSource
from .ply_body import Body, Column, Columns, spread
from .ply_header import Element, Header


class BinaryBody(Body):
    """Places are bytes of the file."""

    def __init__(self, source: MeshSource, header: Header) -> None:
        super().__init__(source, header, len(source.data))
        self.place = header.end
        self.bytes = np.frombuffer(source.data, dtype=np.uint8)

    def width(self, type: str) -> int:
        return np.dtype(type).itemsize

    def reader(self, type: str) -> Any:
        data, width = self.source.data, self.width(type)
        if type[-2:] == "u1":
            return data.__getitem__
        order: Literal["big", "little"] = "big" if type[0] == ">" else "little"
        signed = type[-2] == "i"
        return lambda place: int.from_bytes(data[place : place + width], order, signed=signed)

    def read_fixed(self, element: Element, lengths: list[int], columns: Columns) -> bool:
        fields: list[Any] = []
        for i, p in enumerate(element.properties):
            if p.count_type:
                fields += [(f"n{i}", p.count_type), (f"v{i}", p.type, (lengths[i],))]
            else:
                fields.append((f"v{i}", p.type))
        row = np.dtype(fields)
        if self.place + row.itemsize * element.count > self.size:
            return False
        table = np.frombuffer(self.source.data, row, element.count, self.place)
        lists = [i for i, p in enumerate(element.properties) if p.count_type]
        if any((table[f"n{i}"] != lengths[i]).any() for i in lists):
            return False
        for i, p in enumerate(element.properties):
            counts = np.full(element.count, lengths[i]) if i in lists else None
            columns[element.name, p.name] = Column(table[f"v{i}"].ravel(), counts)
        self.place += row.itemsize * element.count
        return True

    def gather(self, type: str, starts: Ints, counts: Ints | None) -> NDArray[Any]:
        width = self.width(type)
        places = starts if counts is None else spread(starts, counts, width)
        values: NDArray[Any] = self.bytes[places[:, None] + np.arange(width)].view(type)
        return values.ravel()

    def check_end(self) -> None:
        rest = self.source.data[self.place :].strip(b"\0 \t\r\n")
        if rest:
            received = f"{len(rest)} bytes after the elements of the header"
            self.source.fail(received, "none; export it again")
