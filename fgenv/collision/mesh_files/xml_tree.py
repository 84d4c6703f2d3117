"""XML documents that may be untrusted: no entities, no external files, bounded depth."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NoReturn
from xml.parsers import expat

from .content import MeshSource

MAX_DEPTH = 256
SEPARATOR = " "  # between the namespace and the name, as expat reports them


class Element:
    """An XML element.

    Attributes:
        tag: name without namespace.
        namespace: its URI; "" if there is none.
        attributes: values by name; those with a namespace as "URI name".
        line: in the file, from 1.
        children: elements.
        text: all text directly inside.
        rows: attribute values of children that the parser stores as numbers, by tag.
        prefixes: namespaces by prefix, declared in the document; only of the root.
    """

    __slots__ = ("attributes", "children", "line", "namespace", "prefixes", "rows", "tag", "text")

    def __init__(self, name: str, attributes: dict[str, str], line: int) -> None:
        self.namespace, _, self.tag = name.rpartition(SEPARATOR)
        self.attributes = attributes
        self.line = line
        self.children: list[Element] = []
        self.text = ""
        self.rows: dict[str, array[float]] = {}
        self.prefixes: dict[str, str] = {}

    def get(self, name: str, default: str = "") -> str:
        """The value of an attribute."""
        return self.attributes.get(name, default)

    def all(self, *tags: str) -> list[Element]:
        """The children with one of these tags."""
        return [child for child in self.children if child.tag in tags]

    def first(self, tag: str) -> Element | None:
        """The first child with a tag; None if there is none."""
        return next((child for child in self.children if child.tag == tag), None)

    def below(self) -> Iterator[Element]:
        """This element and all elements inside, in document order."""
        left = [self]
        while left:
            element = left.pop()
            yield element
            left.extend(reversed(element.children))

    def __str__(self) -> str:
        named = self.get("id") or self.get("name")
        return f"<{self.tag} {named[:60]!r}>" if named else f"<{self.tag}>"


def parse_xml(
    source: MeshSource, data: bytes, rows: Mapping[str, Sequence[str]] | None = None, part: str = ""
) -> Element:
    """The root element of a document.

    Args:
        rows: attributes of elements that are only numbers, by tag; they are stored in the parent's
            `rows` instead of one element each.
        part: name of the document within an archive, for messages.

    Raises:
        ValueError: malformed XML, a document type, or elements nested too deeply.
    """
    return _Builder(source, rows or {}, part).parse(data)


class _Builder:
    def __init__(self, source: MeshSource, rows: Mapping[str, Sequence[str]], part: str) -> None:
        self.source = source
        self.rows = rows
        self.part = f" in {part}" if part else ""
        self.fields: dict[str, tuple[str, ...]] = {}  # of rows, by full name; () of other elements
        self.in_row = False
        self.root = Element("", {}, 0)
        self.stack = [self.root]
        self.texts: list[list[str]] = [[]]
        self.parser = expat.ParserCreate(namespace_separator=SEPARATOR)
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._document_type
        self.parser.StartNamespaceDeclHandler = self._namespace

    def parse(self, data: bytes) -> Element:
        try:
            self.parser.Parse(data, True)
        except expat.ExpatError as error:
            if self.root.children and len(self.stack) == 1:
                self._fail("bytes after the end of the XML", "nothing after it; remove them")
            reason = expat.ErrorString(error.code)
            self._fail(f"malformed XML ({reason})", "a complete file; export it again")
        except (LookupError, UnicodeError, ValueError) as error:
            if str(error).startswith("path:"):
                raise
            self._fail("an unknown encoding", "UTF-8")
        self.root.children[0].prefixes = self.root.prefixes
        return self.root.children[0]

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        if self.in_row:
            self._fail("an element inside a row of numbers", "a row without content")
        fields = self.fields.get(name)
        if fields is None:
            fields = self.fields[name] = tuple(self.rows.get(name.rpartition(SEPARATOR)[2], ()))
        if fields:
            self.in_row = True
            self._store(name, fields, attributes)
            return
        if len(self.stack) > MAX_DEPTH:
            self._fail(f"elements nested over {MAX_DEPTH} deep", "a flat document")
        element = Element(name, attributes, self.parser.CurrentLineNumber)
        self.stack[-1].children.append(element)
        self.stack.append(element)
        self.texts.append([])

    def _store(self, name: str, fields: tuple[str, ...], attributes: dict[str, str]) -> None:
        tag, rows = name.rpartition(SEPARATOR)[2], self.stack[-1].rows
        if tag not in rows:
            rows[tag] = array("d")
        try:
            rows[tag].extend([float(attributes[field]) for field in fields])
        except KeyError as error:
            self._fail(f"no value for {error.args[0]} of <{tag}>", "a number")
        except ValueError:
            values = [attributes[field][:20] for field in fields]
            self._fail(f"{values} for {', '.join(fields)} of <{tag}>", "numbers")

    def _end(self, _: str) -> None:
        if self.in_row:
            self.in_row = False
            return
        self.stack.pop().text = "".join(self.texts.pop())

    def _text(self, text: str) -> None:
        self.texts[-1].append(text)

    def _namespace(self, prefix: str | None, uri: str | None) -> None:
        self.root.prefixes.setdefault(prefix or "", uri or "")

    def _document_type(self, *_: Any) -> None:
        """It may define entities, or defaults of attributes in another file."""
        self._fail("a document type (<!DOCTYPE>)", "XML without entities; remove it")

    def _fail(self, received: str, expected: str) -> NoReturn:
        self.source.fail(received + self.part, expected, line=self.parser.CurrentLineNumber)
