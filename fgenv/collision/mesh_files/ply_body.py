"""The elements of a PLY file as columns, one array per property, whatever their encoding."""

from __future__ import annotations

from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Ints

from .content import MeshSource
from .ply_header import Element, Header


class Column(NamedTuple):
    """The values of a property; of a list property with the number of values per element."""

    values: NDArray[Any]
    counts: Ints | None = None


Columns = dict[tuple[str, str], Column]  # by element and property


class Body:
    """Elements as rows of items: bytes, or the numbers of a text."""

    def __init__(self, source: MeshSource, header: Header, size: int) -> None:
        self.source, self.header = source, header
        self.place, self.size = 0, size

    def read(self) -> Columns:
        columns: Columns = {}
        for element in self.header.elements:
            least = sum(self.width(p.count_type or p.type) for p in element.properties)
            if element.count * least > self.size - self.place:
                self.fail_short(element)
            if any(p.count_type for p in element.properties):
                self.read_lists(element, columns)
            elif element.count and element.properties:
                self.read_fixed(element, [0] * len(element.properties), columns)
            else:
                for p in element.properties:
                    columns[element.name, p.name] = Column(np.empty(0, p.type or float))
        self.check_end()
        return columns

    def read_lists(self, element: Element, columns: Columns) -> None:
        """Rows with lists: at once if all rows are as long as the first, else one by one."""
        if element.count == 0:
            empty = np.empty(0, dtype=np.int64)
            for p in element.properties:
                columns[element.name, p.name] = Column(empty, empty if p.count_type else None)
            return
        begin = self.place
        lengths, _ = self.walk(element, 1)
        self.place = begin
        if self.read_fixed(element, [column[0] for column in lengths], columns):
            return
        lengths, starts = self.walk(element, element.count)
        for i, p in enumerate(element.properties):
            counts = np.array(lengths[i]) if p.count_type else None
            values = self.gather(p.type, np.array(starts[i]), counts)
            columns[element.name, p.name] = Column(values, counts)

    def walk(self, element: Element, rows: int) -> tuple[list[list[int]], list[list[int]]]:
        """Lengths of the lists and places of the values of rows, by property."""
        lengths: list[list[int]] = [[] for _ in element.properties]
        starts: list[list[int]] = [[] for _ in element.properties]
        steps = [
            (self.reader(p.count_type) if p.count_type else None,
             self.width(p.count_type) if p.count_type else 0,
             self.width(p.type), lengths[i].append, starts[i].append)
            for i, p in enumerate(element.properties)
        ]  # fmt: skip
        place, size = self.place, self.size
        for _ in range(rows):
            for read, head, width, add_length, add_start in steps:
                count = 1
                if read is not None:
                    if place + head > size:
                        self.fail_short(element)
                    count = read(place)
                    if count < 0:
                        self.source.fail(f"a list of {count} values", "0 or more")
                    place += head
                add_length(count)
                add_start(place)
                place += count * width
                if place > size:
                    self.fail_short(element)
        self.place = place
        return lengths, starts

    def fail_short(self, element: Element) -> NoReturn:
        self.source.fail(
            f"a truncated file: it ends within the {element.count} elements {element.name} of"
            " its header",
            "all of them; copy or export it again",
        )

    def width(self, type: str) -> int:
        raise NotImplementedError

    def reader(self, type: str) -> Any:
        """A function from a place to the integer there."""
        raise NotImplementedError

    def read_fixed(self, element: Element, lengths: list[int], columns: Columns) -> bool:
        """Read rows with lists of known lengths; False if the rows have other lengths."""
        raise NotImplementedError

    def gather(self, type: str, starts: Ints, counts: Ints | None) -> NDArray[Any]:
        """Values at places, `counts` at each."""
        raise NotImplementedError

    def check_end(self) -> None:
        raise NotImplementedError


def spread(starts: Ints, counts: Ints, width: int) -> Ints:
    """Places of the values of lists."""
    owner = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner]
    places: Ints = starts[owner] + width * within
    return places
