"""The elements of a text PLY file: numbers separated by white space."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Ints

from .content import MeshSource
from .ply_body import Body, Column, Columns, spread
from .ply_header import Element, Header
from .text import parse, shown


class TextBody(Body):
    """Places are positions among the numbers."""

    def __init__(self, source: MeshSource, header: Header) -> None:
        values = parse(source.data[header.end :], np.float64)
        if values is None:
            _fail_word(source, header)
        super().__init__(source, header, len(values))
        self.values = values

    def width(self, type: str) -> int:
        return 1

    def reader(self, type: str) -> Any:
        values = self.values

        def read(place: int) -> int:
            value = float(values[place])
            if not value.is_integer():
                self.source.fail(f"a list of {value:g} values", "a whole number")
            return int(value)

        return read

    def read_fixed(self, element: Element, lengths: list[int], columns: Columns) -> bool:
        widths = [lengths[i] + 1 if p.count_type else 1 for i, p in enumerate(element.properties)]
        end = self.place + sum(widths) * element.count
        if end > self.size:
            return False
        table = self.values[self.place : end].reshape(element.count, -1)
        firsts = np.cumsum(widths) - widths
        for first, p, length in zip(firsts, element.properties, lengths, strict=True):
            if p.count_type and (table[:, first] != length).any():
                return False
        for first, p, length in zip(firsts, element.properties, lengths, strict=True):
            if p.count_type:
                values = table[:, first + 1 : first + 1 + length].ravel()
                columns[element.name, p.name] = Column(values, np.full(element.count, length))
            else:
                columns[element.name, p.name] = Column(table[:, first])
        self.place = end
        return True

    def gather(self, type: str, starts: Ints, counts: Ints | None) -> NDArray[Any]:
        return self.values[starts if counts is None else spread(starts, counts, 1)]

    def check_end(self) -> None:
        if self.place < self.size:
            received = f"{self.size - self.place} numbers after the elements of the header"
            self.source.fail(received, "none; export it again")


def _fail_word(source: MeshSource, header: Header) -> NoReturn:
    """Raise the error of the first word of the body that is not a number."""
    lines = source.data[header.end :].split(b"\n")
    for number, line in enumerate(lines, header.lines + 1):
        if parse(line, np.float64) is None:
            word = next((w for w in line.split() if parse(w, np.float64) is None), line)
            source.fail(shown(word), "a number", line=number)
    source.fail("words", "numbers")
