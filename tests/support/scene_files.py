"""Generated files of scene formats: glTF, COLLADA, 3MF."""

from __future__ import annotations

import base64
import io
import json
import struct
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from fgenv.arrays import Faces, Floats, Vertices
from fgenv.collision.mesh_files import FileMesh, read_mesh_file

AREA, VOLUME, EXTENTS = 22.0, 6.0, (1.0, 2.0, 3.0)
QUADS = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)


def box() -> tuple[Vertices, Faces]:
    """A box from (0, 0, 0) to (1, 2, 3): vertices (8, 3) and triangles (12, 3)."""
    corners = [(x, y, z) for z in (0.0, 3.0) for y in (0.0, 2.0) for x in (0.0, 1.0)]
    return np.array(corners), np.vstack([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])


def read(folder: Path, name: str, data: bytes) -> FileMesh:
    """Write a file and read it as a mesh."""
    path = folder / name
    path.write_bytes(data)
    return read_mesh_file(path)


def measures(mesh: FileMesh) -> tuple[float, float, list[float]]:
    """Area, signed volume and extents by trimesh."""
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    return float(solid.area), float(solid.volume), np.ptp(corners, axis=0).tolist()


def assert_one_line(error: BaseException) -> None:
    """Check the form of an error of a file."""
    assert str(error).startswith("path: ")
    assert "\n" not in str(error)
    assert len(str(error)) < 600


def assert_box(mesh: FileMesh, copies: int = 1, scale: float = 1.0, rtol: float = 1e-6) -> None:
    """Check for boxes from `box`; extents are compared for one copy alone."""
    area, volume, extents = measures(mesh)
    np.testing.assert_allclose(area, copies * AREA * scale**2, rtol=rtol)
    np.testing.assert_allclose(volume, copies * VOLUME * scale**3, rtol=rtol)
    if copies == 1:
        np.testing.assert_allclose(sorted(extents), np.multiply(EXTENTS, scale), rtol=rtol)


class GltfFile:
    """A glTF file with one buffer; `content` is its JSON and can be changed."""

    TYPES: Mapping[str, int] = {
        "i1": 5120,
        "u1": 5121,
        "i2": 5122,
        "u2": 5123,
        "u4": 5125,
        "f4": 5126,
    }

    def __init__(self) -> None:
        self.blob = bytearray()
        self.content: dict[str, Any] = {"asset": {"version": "2.0"}}

    def add(self, kind: str, **item: Any) -> int:
        """Add an item of a kind; its index."""
        items = self.content.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def view(self, data: bytes, **item: Any) -> int:
        """Add bytes to the buffer; the index of their view."""
        self.blob.extend(b"\xaa" * (-len(self.blob) % 4))
        at = len(self.blob)
        self.blob.extend(data)
        return self.add("bufferViews", buffer=0, byteOffset=at, byteLength=len(data), **item)

    def accessor(
        self, values: ArrayLike, kind: str, code: str = "f4", stride: int = 0, **item: Any
    ) -> int:
        """Add an array (n, width); the index of its accessor. Extra bytes fill the stride."""
        array = np.asarray(values)
        rows = [row.tobytes() for row in array.astype("<" + code)]
        views = {"byteStride": stride} if stride else {}
        view = self.view(b"".join(row.ljust(stride, b"\xff") for row in rows), **views)
        common = {"componentType": self.TYPES[code], "count": len(array), "type": kind}
        return self.add("accessors", bufferView=view, **common, **item)

    def box_mesh(self, code: str = "u2", **primitive: Any) -> int:
        """Add the mesh of `box`; its index."""
        vertices, faces = box()
        attributes = {"POSITION": self.accessor(vertices, "VEC3")}
        indices = self.accessor(faces.ravel(), "SCALAR", code)
        primitives = [{"attributes": attributes, "indices": indices, **primitive}]
        return self.add("meshes", primitives=primitives)

    def scene(self, *nodes: Mapping[str, Any]) -> GltfFile:
        """Add nodes, all roots of a new scene."""
        roots = [self.add("nodes", **node) for node in nodes]
        self.add("scenes", nodes=roots)
        return self

    def text(self, uri: str | None = None) -> bytes:
        """The file as JSON; the buffer is inside unless a URI is given."""
        inside = "data:application/octet-stream;base64," + base64.b64encode(self.blob).decode()
        buffer = {"byteLength": len(self.blob), "uri": uri or inside}
        return json.dumps({"buffers": [buffer], **self.content}).encode()

    def glb(self) -> bytes:
        """The file as GLB."""
        content = {"buffers": [{"byteLength": len(self.blob)}], **self.content}
        return glb(json.dumps(content).encode(), bytes(self.blob))


def glb(text: bytes, blob: bytes) -> bytes:
    """A GLB of a JSON text and a binary chunk."""
    chunks = b""
    for kind, data, fill in ((b"JSON", text, b" "), (b"BIN\0", blob, b"\0")):
        data += fill * (-len(data) % 4)
        chunks += struct.pack("<I", len(data)) + kind + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def one_box(**node: Any) -> GltfFile:
    """A scene with one box."""
    file = GltfFile()
    return file.scene({"mesh": file.box_mesh(), **node})


def numbers(values: ArrayLike) -> str:
    """Numbers as text."""
    return " ".join(f"{x:.17g}" for x in np.asarray(values).ravel().tolist())


def polygons_of_box() -> str:
    """The faces of `box` as a <polylist>."""
    return (
        '<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/>'
        f"<vcount>4 4 4 4 4 4</vcount><p>{numbers(QUADS)}</p></polylist>"
    )


def geometry(primitives: str = "", vertices: Floats | None = None, name: str = "box") -> str:
    """A COLLADA geometry; default: `box`."""
    points = box()[0] if vertices is None else vertices
    return f"""<geometry id="{name}"><mesh><source id="s">
<float_array id="a" count="{points.size}">{numbers(points)}</float_array>
<technique_common><accessor source="#a" count="{len(points)}" stride="3"><param name="X"
type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
{primitives or polygons_of_box()}</mesh></geometry>"""


def collada(
    nodes: str = '<node><instance_geometry url="#box"/></node>',
    geometries: str = "",
    asset: str = "",
    more: str = "",
) -> bytes:
    """A COLLADA file with one scene."""
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>{more}
<library_geometries>{geometries or geometry()}</library_geometries>
<library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>""".encode()


def zipped(members: Mapping[str, str | bytes]) -> bytes:
    """A zip archive."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return out.getvalue()


def box_object(name: str = "1", attributes: str = "", extra: str = "") -> str:
    """A 3MF object: `box`."""
    vertices, faces = box()
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in vertices)
    corners = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    return (
        f'<object id="{name}" {attributes}><mesh><vertices>{points}</vertices>'
        f"<triangles>{corners}</triangles>{extra}</mesh></object>"
    )


def model(
    resources: str, build: str = '<item objectid="1"/>', attributes: str = 'unit="meter"'
) -> str:
    """A 3MF model."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?><model '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
        'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" '
        f"{attributes}><resources>{resources}</resources><build>{build}</build></model>"
    )


RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="r" Target="/3D/3dmodel.model" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def threemf(text: str, **others: str) -> bytes:
    """A 3MF package of a model; `others` are more models in the folder 3D."""
    members = {f"3D/{name}.model": content for name, content in others.items()}
    return zipped({"_rels/.rels": RELATIONS, "3D/3dmodel.model": text, **members})
