"""Sources of COLLADA: positions of vertices in a table of numbers."""

from __future__ import annotations

import numpy as np

from fgenv.arrays import Vertices

from .collada_document import ColladaDocument
from .xml_tree import Element


def positions_of(document: ColladaDocument, chosen: Element, mesh: Element) -> Vertices:
    """Positions (n, 3) that a VERTEX input refers to."""
    vertices = _child(document, mesh, chosen, ("vertices",))
    found = [i for i in vertices.all("input") if i.get("semantic") == "POSITION"]
    if len(found) != 1:
        document.fail(vertices, f"{len(found)} POSITION inputs in {vertices}", "one")
    source = _child(document, mesh, found[0], ("source",))
    common = source.first("technique_common")
    accessor = common.first("accessor") if common else None
    if accessor is None:
        document.fail(source, f"{source} without accessor", "<technique_common> with <accessor>")
    values = _values(document, source, accessor)
    count, offset = document.whole(accessor, "count"), document.whole(accessor, "offset", 0)
    stride = document.whole(accessor, "stride", 1)
    columns = _columns(document, accessor, stride)
    needed = offset + stride * (count - 1) + max(columns) + 1 if count else 0
    if needed > len(values):
        document.fail(
            accessor,
            f"{len(values)} numbers in {source}",
            f"{needed}, for {count} vertices; the file is damaged",
        )
    rows = offset + stride * np.arange(count)
    positions: Vertices = values[rows[:, None] + np.array(columns)]
    if not np.isfinite(positions).all():
        document.fail(source, f"nan or inf in {source}", "finite coordinates")
    return positions


def _child(
    document: ColladaDocument, mesh: Element, element: Element, tags: tuple[str, ...]
) -> Element:
    """The child of a mesh that the source attribute of an input refers to."""
    name = element.get("source")
    found = [child for child in mesh.all(*tags) if "#" + child.get("id") == name]
    if len(found) != 1:
        document.fail(
            element,
            f"the {element.get('semantic')} input of source {name[:60]!r}",
            f"the id of one <{tags[0]}> of its mesh; {len(found)} have it",
        )
    return found[0]


def _values(document: ColladaDocument, source: Element, accessor: Element) -> Vertices:
    """The numbers of a source."""
    name = accessor.get("source")
    arrays = [c for c in source.all("float_array", "int_array") if "#" + c.get("id") == name]
    if len(arrays) != 1:
        document.fail(accessor, f"an accessor of {name[:60]!r}", f"the <float_array> of {source}")
    count = document.whole(arrays[0], "count")
    values: Vertices = document.numbers(arrays[0], count=count)
    return values


def _columns(document: ColladaDocument, accessor: Element, stride: int) -> list[int]:
    """Places of x, y, z within a vertex: of the parameters of these names, else the first three.

    A parameter without a name is skipped, as the specification says.
    """
    names = [param.get("name") for param in accessor.all("param")]
    if all(axis in names for axis in "XYZ"):
        columns = [names.index(axis) for axis in "XYZ"]
    else:
        columns = [i for i, name in enumerate(names) if name][:3]
    if len(columns) < 3 or max(columns) >= stride:
        document.fail(
            accessor, f"an accessor with {len(names)} parameters, stride {stride}", "X, Y and Z"
        )
    return columns
