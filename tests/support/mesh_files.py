"""Files of one solid in each format and construct, with known area, volume and extents.

The solid is a prism over an L: its two ends are concave polygons of six corners, its sides are
quadrilaterals. A fan from the first corner of an end would fill the notch.
"""

from __future__ import annotations

import gzip
import io
import struct
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from fgenv.arrays import Floats, Ints

AREA, VOLUME, EXTENTS = 14.0, 3.0, (2.0, 2.0, 1.0)
Polygons = Sequence[Sequence[int]]


@dataclass(frozen=True)
class MeshCase:
    """A file, and what a correct reader finds in it (lengths in meters)."""

    name: str  # of the file
    content: bytes = field(repr=False)
    polygons: int = 0  # faces with more than three corners
    area: float = AREA
    volume: float = VOLUME
    extents: tuple[float, float, float] = EXTENTS
    note: str = ""  # part of a note of the report


def prism() -> tuple[Floats, list[list[int]]]:
    """Vertices (12, 3) and polygons, counter-clockwise seen from outside."""
    flat = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]
    vertices = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in flat])
    sides = [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    return vertices, [list(range(6))[::-1], list(range(6, 12)), *sides]


def prism_triangles() -> tuple[Floats, Ints]:
    """The same with triangles only."""
    vertices, polygons = prism()
    ends = [[5, 0, 1], [5, 1, 2], [5, 2, 3], [5, 3, 4]]
    faces = [face[::-1] for face in ends] + [[i + 6 for i in face] for face in ends]
    for a, b, c, d in polygons[2:]:
        faces += [[a, b, c], [a, c, d]]
    return vertices, np.array(faces)


# STL


def binary_stl(
    vertices: Floats, faces: Ints, header: bytes = b"", count: int | None = None
) -> bytes:
    """A binary STL file; `count` replaces the number of faces in its header."""
    head = header.ljust(80, b" ") + struct.pack("<I", len(faces) if count is None else count)
    zero = (0.0, 0.0, 0.0)
    return head + b"".join(
        struct.pack("<12fH", *zero, *vertices[face].ravel().tolist(), 0) for face in faces
    )


def facets(vertices: Floats, faces: Ints) -> str:
    """The facets of a text STL file."""
    text = []
    for face in faces:
        corners = "".join(f"      vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices[face])
        text.append(f"  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n")
    return "".join(text)


def _stl() -> Iterator[MeshCase]:
    mesh = prism_triangles()
    body = facets(*mesh)
    half = len(mesh[1]) // 2
    halves = [facets(mesh[0], mesh[1][:half]), facets(mesh[0], mesh[1][half:])]
    yield MeshCase("binary.stl", binary_stl(*mesh))
    yield MeshCase("binary_solid.stl", binary_stl(*mesh, header=b"solid made by a program"))
    yield MeshCase("upper_case.STL", binary_stl(*mesh))
    texts = {
        "text": f"solid a b c\n{body}endsolid a b c\n",
        "no_name": f"solid\n{body}endsolid\n",
        "windows": f"solid a\n{body}endsolid a\n".replace("\n", "\r\n"),
        "macintosh": f"solid a\n{body}endsolid a\n".replace("\n", "\r"),
        "upper": f"solid a\n{body}endsolid a\n".upper(),
        "blank_lines": "\n\n" + f"solid a\n{body}endsolid a\n".replace("\n", "\n\n \t\n"),
        "byte_order_mark": f"\ufeffsolid a\n{body}endsolid a\n",
        "other_end": f"solid a\n{body}endsolid b",
    }
    for name, text in texts.items():
        yield MeshCase(f"{name}.stl", text.encode())
    two = f"solid a\n{halves[0]}endsolid a\nsolid b\n{halves[1]}endsolid b\n"
    yield MeshCase("solids.stl", two.encode(), note="2 solids")
    empty = f"solid a\nendsolid a\nsolid b\n{body}endsolid b\n"
    yield MeshCase("empty_solid.stl", empty.encode(), note="2 solids")
    for name, text in {
        "no_end": f"solid a\n{body}",
        "end_solid": f"solid a\n{body}end solid a\n",
        "cut_end": f"solid a\n{body}endso",
        "no_end_between": f"solid a\n{halves[0]}solid b\n{halves[1]}endsolid b\n",
    }.items():
        yield MeshCase(f"{name}.stl", text.encode(), note="no endsolid")


# OBJ


def obj(vertices: Floats, polygons: Polygons, corner: str = "{0}", extra: str = "") -> str:
    """An OBJ file; `corner` formats the index of a vertex, `extra` follows its coordinates."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}{extra}\n" for x, y, z in vertices]
    lines += ["f " + " ".join(corner.format(i + 1) for i in face) + "\n" for face in polygons]
    return "".join(lines)


def relative_obj(vertices: Floats, polygons: Polygons) -> str:
    """An OBJ file with the vertices of each face before it, and negative indices."""
    lines = []
    for face in polygons:
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices[list(face)]]
        lines.append("f " + " ".join(str(i - len(face)) for i in range(len(face))) + "\n")
    return "".join(lines)


def _obj() -> Iterator[MeshCase]:
    vertices, polygons = prism()
    triangles = prism_triangles()[1].tolist()
    plain = obj(vertices, polygons)
    heads = "mtllib none.mtl\no part\ng a b\ns off\nusemtl none\nvt 0 0\nvn 0 0 1\nvp 0.5\n"
    split = plain.index("f ")
    faces = plain[split:].splitlines(keepends=True)
    groups = "".join(f"g group{i}\n{face}g empty{i}\n" for i, face in enumerate(faces))
    texts = {
        "polygons": plain,
        "relative": relative_obj(vertices, polygons),
        "textures": "vt 0 0\n" + obj(vertices, polygons, "{0}/1"),
        "normals": "vn 0 0 1\n" + obj(vertices, polygons, "{0}//1"),
        "both": "vt 0 0\nvn 0 0 1\n" + obj(vertices, polygons, "{0}/1/1"),
        "broken_references": obj(vertices, polygons, "{0}/99/-7"),
        "colors": obj(vertices, polygons, extra=" 0.1 0.2 0.3"),
        "weights": obj(vertices, polygons, extra=" 1.0"),
        "weights_and_colors": obj(vertices, polygons, extra=" 1.0 0.1 0.2 0.3"),
        "continued": plain.replace("f ", "f \\\n  ").replace("v 2 0", "v 2 \\\r\n 0"),
        "comments": "# a # b\n" + plain.replace("\n", " # c\n"),
        "materials": heads + plain,
        "groups": plain[:split] + groups,
        "faces_first": plain[split:] + plain[:split],
        "windows": plain.replace("\n", "\r\n"),
        "tabs": plain.replace(" ", " \t"),
        "no_last_newline": plain.rstrip(),
        "old_faces": plain.replace("f ", "fo "),
    }
    for name, text in texts.items():
        yield MeshCase(f"{name}.obj", text.encode(), polygons=8)
    yield MeshCase("triangles.OBJ", obj(vertices, triangles).encode())
    lines = plain + "l 1 2 3\nl 1 2\n"
    yield MeshCase("polylines.obj", lines.encode(), polygons=8, note="2 polylines")
    yield MeshCase("points.obj", (plain + "p 1\n").encode(), polygons=8, note="1 point")
    yield MeshCase("thin.obj", (plain + "f 1 2\n").encode(), polygons=8, note="fewer than three")


# PLY


def ply_header(kind: str, elements: Sequence[tuple[str, int, Sequence[str]]]) -> bytes:
    """A header of elements with their properties, e.g. `float x`."""
    lines = ["ply", f"format {kind} 1.0", "comment a comment", "obj_info a note"]
    for name, count, properties in elements:
        lines.append(f"element {name} {count}")
        lines += [f"property {p}" for p in properties]
    return ("\n".join([*lines, "end_header"]) + "\n").encode()


def ply_faces(polygons: Polygons, kind: str, types: str = "Bi", tail: bytes = b"") -> bytes:
    """Lists of corners; `types` are of `struct`, `tail` follows each list."""
    if kind == "ascii":
        return "".join(
            f"{len(f)} {' '.join(map(str, f))} {tail.decode()}\n" for f in polygons
        ).encode()
    order = ">" if "big" in kind else "<"
    return b"".join(
        struct.pack(f"{order}{types[0]}{len(f)}{types[1]}", len(f), *f) + tail for f in polygons
    )


def ply_vertices(vertices: Floats, kind: str, types: str = "fff", tail: str = "") -> bytes:
    """Coordinates; `tail` are further numbers of a text file."""
    if kind == "ascii":
        return "".join(f"{x:.9g} {y:.9g} {z:.9g}{tail}\n" for x, y, z in vertices).encode()
    order = ">" if "big" in kind else "<"
    rows = np.empty(len(vertices), [(f"c{i}", order + t) for i, t in enumerate(types)])
    for i in range(3):
        rows[f"c{i}"] = vertices[:, i]
    return rows.tobytes()


XYZ = ("float x", "float y", "float z")
INDICES = ("list uchar int vertex_indices",)
PLY_KINDS = ("ascii", "binary_little_endian", "binary_big_endian")


def _ply() -> Iterator[MeshCase]:
    vertices, polygons = prism()
    triangles: Polygons = prism_triangles()[1].tolist()
    n, count = len(vertices), len(polygons)
    for kind in PLY_KINDS:
        points = ply_vertices(vertices, kind)
        head = ply_header(kind, [("vertex", n, XYZ), ("face", count, INDICES)])
        yield MeshCase(f"{kind}.ply", head + points + ply_faces(polygons, kind), polygons=8)
        head = ply_header(kind, [("vertex", n, XYZ), ("face", len(triangles), INDICES)])
        yield MeshCase(f"{kind}_triangles.ply", head + points + ply_faces(triangles, kind))
        head = ply_header(kind, [("face", count, INDICES), ("vertex", n, XYZ)])
        yield MeshCase(f"{kind}_faces_first.ply", head + ply_faces(polygons, kind) + points, 8)
        head = ply_header(
            kind, [("vertex", n, ("double x", "short y", "uchar z")),
                   ("face", count, ("list int ushort vertex_index",))]
        )  # fmt: skip
        yield MeshCase(
            f"{kind}_types.ply",
            head + ply_vertices(vertices, kind, "dhB") + ply_faces(polygons, kind, "iH"),
            polygons=8,
        )
        yield _tristrips(kind)
    yield from _ply_extras(vertices, polygons)


def _tristrips(kind: str) -> MeshCase:
    """Each polygon as a strip, all in one list with -1 between them."""
    vertices, _ = prism()
    strip: list[int] = []
    for face in prism_triangles()[1].tolist():
        strip += [*face, -1]
    head = ply_header(
        kind, [("vertex", len(vertices), XYZ), ("tristrips", 1, ("list int int vertex_indices",))]
    )
    body = ply_vertices(vertices, kind) + ply_faces([strip], kind, "ii")
    return MeshCase(f"{kind}_strips.ply", head + body)


def _ply_extras(vertices: Floats, polygons: Polygons) -> Iterator[MeshCase]:
    """Further properties and elements, before and after those that matter."""
    n, count = len(vertices), len(polygons)
    colored = (*XYZ, "uchar red", "list uchar float weights")
    face = ("list uchar int vertex_indices", "uchar flags", "list uchar float texcoord")
    elements = [("camera", 2, ("int a", "list uchar uchar b")), ("vertex", n, colored),
                ("face", count, face), ("edge", 1, ("int vertex1", "int vertex2"))]  # fmt: skip
    rows = [f"{x} {y} {z} 255 {i % 3} {'0.5 ' * (i % 3)}\n" for i, (x, y, z) in enumerate(vertices)]
    text = "7 2 1 2\n8 0\n" + "".join(rows)
    text += ply_faces(polygons, "ascii", tail=b"1 2 0.5 0.5").decode() + "0 1\n"
    yield MeshCase("extras.ply", ply_header("ascii", elements) + text.encode(), polygons=8)
    body = struct.pack("<iBBB", 7, 2, 1, 2) + struct.pack("<iB", 8, 0)
    for i, (x, y, z) in enumerate(vertices):
        body += struct.pack(f"<fffBB{i % 3}f", x, y, z, 255, i % 3, *[0.5] * (i % 3))
    tail = struct.pack("<BBff", 1, 2, 0.5, 0.5)
    body += ply_faces(polygons, "little", tail=tail) + struct.pack("<ii", 0, 1)
    head = ply_header("binary_little_endian", elements)
    yield MeshCase("extras_binary.ply", head + body, polygons=8)
    windows = ply_header("ascii", [("vertex", n, XYZ), ("face", count, INDICES)])
    windows += ply_vertices(vertices, "ascii") + ply_faces(polygons, "ascii")
    yield MeshCase("windows.ply", windows.replace(b"\n", b"\r\n"), polygons=8)


# OFF


def off(
    vertices: Floats, polygons: Polygons, header: str = "OFF\n", extra: str = "", color: str = ""
) -> str:
    """An OFF file; `extra` follows the coordinates, `color` the corners."""
    lines = [f"{header}{len(vertices)} {len(polygons)} 0\n"]
    lines += [f"{x:.9g} {y:.9g} {z:.9g}{extra}\n" for x, y, z in vertices]
    lines += [f"{len(f)} {' '.join(map(str, f))}{color}\n" for f in polygons]
    return "".join(lines)


def _off() -> Iterator[MeshCase]:
    mesh = prism()
    plain = off(*mesh)
    texts = {
        "plain": plain,
        "no_keyword": off(*mesh, header=""),
        "same_line": off(*mesh, header="OFF "),
        "comments": "# a\n" + plain.replace("\n", " # b\n# c\n\n"),
        "vertex_colors": off(*mesh, header="COFF\n", extra=" 0.1 0.2 0.3 1"),
        "normals": off(*mesh, header="NOFF\n", extra=" 0 0 1"),
        "all": off(*mesh, header="STCNOFF\n", extra=" 0 0 1 0.1 0.2 0.3 1 0.5 0.5"),
        "face_colors": off(*mesh, color=" 255 0 0"),
        "float_colors": off(*mesh, color=" 1.0 0.5 0.0 1.0"),
        "color_index": off(*mesh, color=" 3"),
        "no_edges": plain.replace(" 8 0\n", " 8\n", 1),
        "windows": plain.replace("\n", "\r\n"),
        "lower": off(*mesh, header="off\n"),
    }
    for name, text in texts.items():
        yield MeshCase(f"{name}.off", text.encode(), polygons=8)
    thin = plain.replace(" 8 0\n", " 9 0\n", 1) + "2 0 1\n"
    yield MeshCase("thin.off", thin.encode(), polygons=8, note="fewer than three")


# Packed files


def zipped(*members: tuple[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    """A zip archive of members: names and contents."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        for name, content in members:
            archive.writestr(name, content)
    return out.getvalue()


def _packed() -> Iterator[MeshCase]:
    stl = binary_stl(*prism_triangles())
    text = obj(*prism()).encode()
    yield MeshCase("part.stl.gz", gzip.compress(stl, mtime=0))
    yield MeshCase("Teil ä.OBJ.GZ", gzip.compress(text, mtime=0), polygons=8)
    yield MeshCase(
        "two_members.stl.gz", gzip.compress(stl[:100], mtime=0) + gzip.compress(stl[100:])
    )
    yield MeshCase("part.zip", zipped(("a/part.obj", text)), polygons=8)
    stored = zipped(("part.STL", stl), ("read me.txt", b"text"), method=zipfile.ZIP_STORED)
    yield MeshCase("stored.zip", stored)
    companion = ("__MACOSX/._part.stl", b"\0" * 9)
    yield MeshCase("macintosh.zip", zipped(("part.stl", stl), companion))


def mesh_cases() -> list[MeshCase]:
    """All files of the text and binary formats STL, OBJ, PLY and OFF, and packed ones."""
    return [*_stl(), *_obj(), *_ply(), *_off(), *_packed()]
