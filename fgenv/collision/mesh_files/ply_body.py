"""The elements of a PLY file as columns: one array per property."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from fgenv.arrays import Ints

from .content import MeshSource
from .ply_header import Element, Header
from .text import parse, shown


class Column(NamedTuple):
    """The values of a property; of a list property with the number of values per element."""

    values: NDArray[Any]
    counts: Ints | None = None


Columns = dict[tuple[str, str], Column]  # by element and property


def read_body(source: MeshSource, header: Header) -> Columns:
    """All properties of all elements; the body must have the size that the header states."""
    if header.kind == "ASCII":
        return _Words(source, header).read()
    return _Binary(source, header).read()


class _Body:
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


class _Binary(_Body):
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
        places = starts if counts is None else _spread(starts, counts, width)
        values: NDArray[Any] = self.bytes[places[:, None] + np.arange(width)].view(type)
        return values.ravel()

    def check_end(self) -> None:
        rest = self.source.data[self.place :].strip(b"\0 \t\r\n")
        if rest:
            received = f"{len(rest)} bytes after the elements of the header"
            self.source.fail(received, "none; export it again")


class _Words(_Body):
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
        return self.values[starts if counts is None else _spread(starts, counts, 1)]

    def check_end(self) -> None:
        if self.place < self.size:
            received = f"{self.size - self.place} numbers after the elements of the header"
            self.source.fail(received, "none; export it again")


def _spread(starts: Ints, counts: Ints, width: int) -> Ints:
    """Places of the values of lists."""
    owner = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(owner)) - (np.cumsum(counts) - counts)[owner]
    places: Ints = starts[owner] + width * within
    return places


def _fail_word(source: MeshSource, header: Header) -> NoReturn:
    """Raise the error of the first word of the body that is not a number."""
    lines = source.data[header.end :].split(b"\n")
    for number, line in enumerate(lines, header.lines + 1):
        if parse(line, np.float64) is None:
            word = next((w for w in line.split() if parse(w, np.float64) is None), line)
            source.fail(shown(word), "a number", line=number)
    source.fail("words", "numbers")
