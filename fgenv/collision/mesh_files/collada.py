"""COLLADA files (.dae), and their archives (.zae): the geometry of the scene."""

from __future__ import annotations

import math
from pathlib import PurePosixPath
from urllib.parse import unquote

from .archive import open_zip, read_member
from .collada_document import ColladaDocument
from .collada_nodes import place_scene
from .content import FileMesh, MeshSource, Unit
from .files import MAX_BYTES
from .scene_parts import SceneParts
from .xml_tree import Element, parse_xml

UP_AXES = {"X_UP": "x", "Y_UP": "y", "Z_UP": "z"}


def read_collada(source: MeshSource) -> FileMesh:
    """Read the scene of a COLLADA file: polygons, placed by the nodes.

    The unit and the up axis are those of the file's asset. Other scenes, unused geometry and
    lines are noted.

    Raises:
        ValueError: malformed XML, a reference without target, data shorter than stated, or an
            element that changes the geometry and is not read: skew, skins, morphs, splines.
    """
    data = _archived(source) if source.data[:2] == b"PK" else source.data
    root = parse_xml(source, data)
    if root.tag != "COLLADA":
        source.fail(f"<{root.tag[:40]}>", "<COLLADA>, the root of a COLLADA file", line=root.line)
    document = ColladaDocument(source, root)
    unit, up = _unit(document), _up(document)
    parts = SceneParts(source)
    place_scene(document, parts)
    name = f"COLLADA {root.get('version')[:10]}".strip()
    vertices, faces = parts.joined()
    counts = document.polygons, document.nonplanar
    return FileMesh(name, vertices, faces, unit, up, *counts, tuple(parts.notes))


def _archived(source: MeshSource) -> bytes:
    """The document of a .zae archive: the one that its manifest names, or its only .dae."""
    with open_zip(source) as archive:
        members = {info.filename: info for info in archive.infolist() if not info.is_dir()}
        names = [name for name in members if name.lower().endswith(".dae")]
        if "manifest.xml" in members:
            manifest = parse_xml(
                source, read_member(source, archive, members["manifest.xml"], MAX_BYTES)
            )
            text = manifest.text.strip().partition("#")[0]
            names = [str(PurePosixPath(unquote(text)))]
        if len(names) != 1 or names[0] not in members:
            shown = ", ".join(name[:60] for name in names[:5]) or "none"
            source.fail(f"the documents {shown} in the archive", "one .dae; unpack the archive")
        return read_member(source, archive, members[names[0]], MAX_BYTES)


def _unit(document: ColladaDocument) -> Unit:
    """The unit of the file; a part with another unit is an error."""
    units = []
    for asset in _assets(document.root):
        element = asset.first("unit")
        if element is not None:
            text = element.get("meter", "1")
            try:
                meters = float(text)
            except ValueError:
                meters = math.nan
            if not (math.isfinite(meters) and meters > 0):
                received = f"the unit of {text[:20]!r} meters"
                document.source.fail(received, "a length over 0", line=element.line)
            units.append(Unit(element.get("name", "meter")[:40], meters))
            if meters != units[0].meters:
                document.source.fail(
                    "parts in two units", "one unit; export the file again", line=element.line
                )
    return units[0] if units else Unit("meter", 1.0)


def _up(document: ColladaDocument) -> str:
    axes = []
    for asset in _assets(document.root):
        element = asset.first("up_axis")
        if element is not None:
            axes.append(element.text.strip())
            if axes[-1] not in UP_AXES or axes[-1] != axes[0]:
                expected = "one of X_UP, Y_UP, Z_UP, the same in the whole file"
                document.source.fail(f"<up_axis> {axes[-1][:20]}", expected, line=element.line)
    return UP_AXES[axes[0]] if axes else "y"


def _assets(root: Element) -> list[Element]:
    """The file's asset, then those of its parts."""
    parts = [element for element in root.below() if element.tag == "asset"]
    own = root.first("asset")
    return [own, *(part for part in parts if part is not own)] if own else parts
