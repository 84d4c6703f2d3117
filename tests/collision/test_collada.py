"""COLLADA files: each construct with known measures, each fault with its reason."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.scene_files import (
    QUADS,
    assert_box,
    assert_one_line,
    box,
    collada,
    geometry,
    measures,
    numbers,
    polygons_of_box,
    read,
    zipped,
)

from fgenv.arrays import Floats
from fgenv.bench.common.meshes import folder
from fgenv.collision import Shape
from fgenv.collision.mesh_files import read_mesh_file, scene_parts

VERTICES, FACES = box()
INPUT = '<input semantic="VERTEX" source="#v" offset="0"/>'
SCENES = b"<library_visual_scenes>"
OTHER = SCENES + b'<visual_scene id="other"/>'
FEET = '<library_lights><asset><unit meter="0.3"/></asset></library_lights>'
BOX = '<instance_geometry url="#box"/>'


def primitives(tag: str, rows: str, count: int) -> bytes:
    """A file with one element of primitives."""
    return collada(geometries=geometry(f'<{tag} count="{count}">{INPUT}{rows}</{tag}>'))


def rows(polygons: Floats, order: list[int] | None = None) -> str:
    return "".join(f"<p>{numbers(polygon[order or slice(None)])}</p>" for polygon in polygons)


def interleaved() -> bytes:
    """Three inputs at two offsets; the normals have no source, which geometry does not need."""
    inputs = (
        '<input semantic="NORMAL" source="#missing" offset="0"/>'
        '<input semantic="VERTEX" source="#v" offset="1"/>'
        '<input semantic="TEXCOORD" source="#missing" offset="1" set="0"/>'
    )
    corners = np.stack([np.full(FACES.size, 99), FACES.ravel()], axis=1)
    element = f'<triangles count="12" material="m">{inputs}<p>{numbers(corners)}</p></triangles>'
    return collada(geometries=geometry(element))


def accessor(params: str, stride: int, offset: int, columns: list[int]) -> bytes:
    """Positions in columns of a wider table, after an offset."""
    table = np.full((8, stride), 77.0)
    table[:, columns] = VERTICES
    values = np.concatenate([np.full(offset, 55.0), table.ravel()])
    text = geometry()
    begin, end = text.index("<float_array"), text.index("</technique_common>")
    array = f'<float_array id="a" count="{values.size}">{numbers(values)}</float_array>'
    common = (
        f'<accessor source="#a" count="8" offset="{offset}" stride="{stride}">{params}</accessor>'
    )
    return collada(geometries=text[:begin] + array + "<technique_common>" + common + text[end:])


def parameters(*names: str) -> str:
    return "".join(
        f'<param name="{n}" type="float"/>' if n else '<param type="float"/>' for n in names
    )


def image() -> bytes:
    """A texture that does not exist, as the foot of ANYmal has it."""
    images = (
        '<library_images><image id="i"><init_from>none.png</init_from></image></library_images>'
    )
    surface = '<surface type="2D"><init_from>gone</init_from></surface>'
    profile = f'<profile_COMMON><newparam sid="n">{surface}</newparam></profile_COMMON>'
    effect = f'<library_effects><effect id="e">{profile}</effect></library_effects>'
    return collada(more=images + effect)


LIBRARY = f'<library_nodes><node id="part">{BOX}</node></library_nodes>'
CAMERA = '<node><skew>45 0 1 0 1 0 0</skew><instance_camera url="#none"/></node>'
BOXES: dict[str, Callable[[], bytes]] = {
    "polylist": collada,
    "triangles": lambda: primitives("triangles", f"<p>{numbers(FACES)}</p>", 12),
    "polygons": lambda: primitives("polygons", rows(QUADS), 6),
    "strips": lambda: primitives("tristrips", rows(QUADS, [0, 1, 3, 2]), 6),
    "fans": lambda: primitives("trifans", rows(QUADS), 6),
    "interleaved": interleaved,
    "columns": lambda: accessor(parameters("X", "Y", "Z"), 3, 4, [0, 1, 2]),
    "other order": lambda: accessor(parameters("Z", "X", "Y"), 3, 0, [1, 2, 0]),
    "unnamed columns": lambda: accessor(parameters("", "A", "B", "", "C"), 6, 2, [1, 2, 4]),
    "missing texture": image,
    "camera": lambda: collada(f"{CAMERA}<node>{BOX}</node>"),
    "library node": lambda: collada('<node><instance_node url="#part"/></node>', more=LIBRARY),
    "encoded reference": lambda: edited('url="#box"', 'url="#b%6Fx"'),
    "mirrored": lambda: collada(f"<node><scale>1 -1 1</scale>{BOX}</node>"),
    "mirrored matrix": lambda: collada(
        f"<node><matrix>{numbers(np.diag([-1, 1, 1, 1]))}</matrix>{BOX}</node>"
    ),
    "no rotation": lambda: collada(f"<node><rotate>0 0 0 0</rotate>{BOX}</node>"),
    "COLLADA 1.5": lambda: collada().replace(b"2005/11", b"2008/03").replace(b"1.4.1", b"1.5.0"),
    "latin-1": lambda: (
        collada(asset="<title>Räder</title>")
        .decode()
        .replace("utf-8", "iso-8859-1")
        .encode("latin-1")
    ),
    "no scene element": lambda: (
        collada().replace(b"<scene>", b"<extra>").replace(b"</scene>", b"</extra>")
    ),
}


@pytest.mark.parametrize("name", BOXES)
def test_every_construct_gives_the_box(name: str, tmp_path: Path) -> None:
    content = BOXES[name]()
    mesh = read(tmp_path, "a.dae", content)
    assert_box(mesh)
    assert_box(read(tmp_path, "a.ZAE", zipped({"a/b.dae": content})))
    polygons = b"<polylist" in content or b"<polygons" in content
    assert mesh.polygons == (6 if polygons else 0)


@pytest.mark.parametrize(
    ("asset", "meters", "up"),
    [
        ("", 1.0, "y"),
        ('<unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis>', 0.0254, "z"),
        ('<unit name="meter"/><up_axis> X_UP </up_axis>', 1.0, "x"),
    ],
)
def test_units_and_axes(asset: str, meters: float, up: str, tmp_path: Path) -> None:
    mesh = read(tmp_path, "a.dae", collada(asset=asset))
    assert_box(mesh, scale=meters)
    assert mesh.up == up
    assert mesh.unit is not None
    assert mesh.unit.meters == meters
    shape = Shape.load(tmp_path / "a.dae", scale=2)
    np.testing.assert_allclose(np.ptp(shape.vertices, axis=0), 2 * meters * np.array([1, 2, 3]))


def test_a_polygon_with_a_hole(tmp_path: Path) -> None:
    flat = [(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), (1, 1, 0), (2, 1, 0), (2, 2, 0), (1, 2, 0)]
    element = (
        f'<polygons count="2">{INPUT}<p>0 1 5</p><ph><p>0 1 2 3</p><h>4 7 6 5</h></ph></polygons>'
    )
    text = collada(geometries=geometry(element, np.array(flat, dtype=float)))
    mesh = read(tmp_path, "a.dae", text)
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0).all()
    np.testing.assert_allclose(normals[:, 2].sum() / 2, 16 - 1 + 2)


def test_lines_and_unused_parts_are_noted(tmp_path: Path) -> None:
    lines = f'<lines count="1">{INPUT}<p>0 1</p></lines>'
    lines += f'<linestrips count="1">{INPUT}<p>0 1 2</p></linestrips>'
    geometries = geometry(polygons_of_box() + lines) + geometry(name="spare")
    text = collada(geometries=geometries).replace(SCENES, OTHER)
    mesh = read(tmp_path, "a.dae", text)
    assert_box(mesh)
    notes = " ".join(mesh.notes)
    for word in ("Lines", "1 geometries", "2 visual scenes"):
        assert word in notes


def test_lookat_places_like_a_camera(tmp_path: Path) -> None:
    node = f"<node><lookat>1 2 3 1 2 13 0 1 0</lookat>{BOX}</node>"
    mesh = read(tmp_path, "a.dae", collada(node))  # it sees +z along -z: a half turn about y
    np.testing.assert_allclose(mesh.vertices, VERTICES * [-1, 1, -1] + [1, 2, 3], atol=1e-12)


def test_an_archive_with_a_manifest(tmp_path: Path) -> None:
    manifest = "<dae_root>scenes/my%20box.dae#scene</dae_root>"
    files: dict[str, str | bytes] = {
        "manifest.xml": manifest,
        "scenes/my box.dae": collada(),
        "b.dae": b"no",
    }
    assert_box(read(tmp_path, "a.zae", zipped(files)))
    del files["manifest.xml"]
    with pytest.raises(ValueError, match=r"my box\.dae, b\.dae"):
        read(tmp_path, "a.zae", zipped(files))


def edited(old: str, new: str) -> bytes:
    """The box with a text replaced, which it has."""
    text = collada().decode()
    assert old in text
    return text.replace(old, new).encode()


def placed(transform: str) -> bytes:
    return collada(f"<node>{transform}{BOX}</node>")


BOMB = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><COLLADA>&b;</COLLADA>'
OUTSIDE = '<!DOCTYPE a [<!ENTITY a SYSTEM "file:///etc/passwd">]><COLLADA>&a;</COLLADA>'
CYCLE = '<library_nodes><node id="n"><instance_node url="#n"/></node></library_nodes>'
SKIN = '<node><instance_controller url="#skin"/></node>'
FAULTS: dict[str, tuple[bytes, str]] = {
    "missing vertices": (edited('source="#v"', 'source="#w"'), "'#w'"),
    "missing positions": (edited('source="#s"', 'source="#w"'), "'#w'"),
    "missing array": (edited('source="#a"', 'source="#w"'), "'#w'"),
    "missing geometry": (edited('url="#box"', 'url="#ball"'), "<geometry> 'ball'"),
    "missing node": (collada('<node><instance_node url="#n"/></node>'), "<node> 'n'"),
    "missing scene": (edited('url="#scene"', 'url="#other"'), "<visual_scene> 'other'"),
    "two geometries of one id": (collada(geometries=geometry() * 2), "the file has 2"),
    "other file": (edited('url="#box"', 'url="b.dae#box"'), "same file"),
    "skew": (placed("<skew>45 0 1 0 1 0 0</skew>"), "<skew>"),
    "skin": (collada(SKIN), "instance_controller.*skin.*armature"),
    "cycle": (collada('<node><instance_node url="#n"/></node>', more=CYCLE), "inside itself"),
    "NaN unit": (collada(asset='<unit meter="NaN"/>'), "'NaN' meters"),
    "zero unit": (collada(asset='<unit meter="0"/>'), "'0' meters"),
    "two units": (collada(asset="<unit/>", more=FEET), "two units"),
    "up axis": (collada(asset="<up_axis>UP</up_axis>"), "X_UP, Y_UP, Z_UP"),
    "vertex out of range": (edited("<p>0 ", "<p>8 "), "vertex index 8"),
    "negative vertex": (edited("<p>0 ", "<p>-1 "), "vertex index -1"),
    "fraction": (edited("<p>0 ", "<p>0.5 "), "whole numbers"),
    "count of polygons": (edited('polylist count="6"', 'polylist count="7"'), "7 that its count"),
    "corners of polygons": (edited("<vcount>4", "<vcount>5"), "25 that its <vcount>"),
    "polygon of two": (edited("<vcount>4", "<vcount>2"), "2 corners"),
    "odd triangles": (primitives("triangles", "<p>0 1 2 3</p>", 1), "4 corners"),
    "short strip": (primitives("tristrips", "<p>0 1</p>", 1), "at least 3"),
    "missing corners": (primitives("triangles", "", 12), "0 <p> elements"),
    "count of numbers": (edited('count="24"', 'count="27"'), "24 numbers.*27"),
    "fewer vertices": (edited('count="8"', 'count="9"'), "27, for 9 vertices"),
    "NaN vertex": (edited('"24">0', '"24">NaN'), "nan"),
    "words": (edited('"24">0', '"24">zero'), "other text"),
    "stride": (edited('stride="3"', 'stride="2"'), "stride 2"),
    "spline": (edited("mesh>", "spline>"), "<spline>"),
    "hull": (edited("mesh>", "convex_mesh>"), "<convex_mesh>"),
    "matrix of 15": (placed("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0</matrix>"), "15 numbers"),
    "projection": (placed(f"<matrix>{numbers(np.diag([1, 1, 1, 2]))}</matrix>"), "last row"),
    "axis of zero": (placed("<rotate>0 0 0 90</rotate>"), "axis"),
    "infinite": (placed("<translate>INF 0 0</translate>"), "infinity"),
    "entities": (BOMB.encode(), "document type"),
    "outside file": (OUTSIDE.encode(), "document type"),
    "truncated": (collada()[:-100], "malformed XML"),
    "bytes after the end": (collada() + b"\0\0", "after the end"),
    "deep": (b"<COLLADA>" + b"<a>" * 10**5, "nested over"),
    "other XML": (b"<svg/>", "<svg>"),
    "other text": (b"v 1 2 3", "malformed XML"),
    "unknown encoding": (b'<?xml version="1.0" encoding="ebcdic-9"?><a/>', "encoding|malformed"),
    "no geometry in the scene": (collada("<node/>"), "without geometry"),
    "two scenes": (BOXES["no scene element"]().replace(SCENES, OTHER), "2 visual scenes"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_refused_with_their_reason(name: str, tmp_path: Path) -> None:
    content, reason = FAULTS[name]
    with pytest.raises(ValueError, match=reason) as caught:
        read(tmp_path, "bad.dae", content)
    assert "bad.dae" in str(caught.value)
    assert_one_line(caught.value)


def test_an_inflating_archive_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="unpacks to"):
        read(tmp_path, "a.zae", zipped({"a.dae": b" " * (64 << 20)}))


def test_instances_of_instances_are_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Thirty nodes that each place the next one twice would place a billion boxes."""
    monkeypatch.setattr(scene_parts, "MAX_NODES", 1000)
    nodes = [
        f'<node id="n{i}">' + f'<instance_node url="#n{i + 1}"/>' * 2 + "</node>" for i in range(30)
    ]
    nodes.append(f'<node id="n30">{BOX}</node>')
    more = f"<library_nodes>{''.join(nodes)}</library_nodes>"
    with pytest.raises(ValueError, match="smaller scene"):
        read(tmp_path, "a.dae", collada('<node><instance_node url="#n0"/></node>', more=more))


NUMBER = st.floats(-2, 2).map(lambda x: round(x, 3))
SCALE = st.sampled_from([-2.0, -1.0, 0.5, 1.0, 3.0])


@st.composite
def transforms(draw: st.DrawFn) -> tuple[str, Floats]:
    """A transform element, and its matrix by SciPy."""
    kind = draw(st.sampled_from(["translate", "rotate", "scale", "matrix"]))
    pose = np.eye(4)
    values = draw(st.tuples(NUMBER, NUMBER, NUMBER))
    if kind == "translate":
        pose[:3, 3] = values
    elif kind == "scale":
        values = draw(st.tuples(SCALE, SCALE, SCALE))
        pose[:3, :3] = np.diag(values)
    elif kind == "matrix":
        pose[:3, :3] = Rotation.from_euler("xyz", values).as_matrix() * draw(SCALE)
        return f"<matrix>{numbers(pose)}</matrix>", pose
    else:
        axis = np.array(values) + [0, 0, 5]
        angle = draw(st.sampled_from([-450.0, -90.0, 0.0, 33.3, 90.0, 180.0, 271.0]))
        turn = Rotation.from_rotvec(np.radians(angle) * axis / np.linalg.norm(axis))
        pose[:3, :3] = turn.as_matrix()
        return f"<rotate>{numbers([*axis, angle])}</rotate>", pose
    return f"<{kind}>{numbers(values)}</{kind}>", pose


@st.composite
def trees(draw: st.DrawFn, depth: int = 0) -> tuple[str, list[Floats]]:
    """A node with a box and nodes inside, and the matrices of its boxes."""
    pose, text = np.eye(4), ""
    for element, matrix in draw(st.lists(transforms(), max_size=3)):
        text += element
        pose = pose @ matrix
    poses = [pose]
    for inner, below in draw(st.lists(trees(depth + 1), max_size=2)) if depth < 3 else ():
        text += inner
        poses += [pose @ matrix for matrix in below]
    return f"<node>{text}{BOX}</node>", poses


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(tree=trees())
def test_node_trees_place_every_box(tree: tuple[str, list[Floats]], tmp_path: Path) -> None:
    text, poses = tree
    mesh = read(tmp_path, "a.dae", collada(text))
    boxes = mesh.vertices.reshape(-1, 8, 3)
    assert len(boxes) == len(poses)
    for pose in poses:
        expected = VERTICES @ pose[:3, :3].T + pose[:3, 3]
        scale = max(1.0, np.abs(expected).max())
        assert np.abs(boxes - expected).max(axis=(1, 2)).min() < 1e-9 * scale
    volume = sum(6 * abs(np.linalg.det(pose[:3, :3])) for pose in poses)
    np.testing.assert_allclose(measures(mesh)[1], volume, rtol=1e-6)


def test_the_foot_of_anymal_loads_without_its_texture() -> None:
    """pycollada drops the primitive of a material with a broken texture."""
    path = "anymal_b_simple_description/meshes/foot/anymal_foot.dae"
    mesh = read_mesh_file(folder("example-robot-data") / path)
    assert len(mesh.faces) == 4604
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), [0.0619, 0.0619, 0.3613], atol=1e-4)


def test_trimesh_reads_the_same(tmp_path: Path) -> None:
    solid = trimesh.creation.annulus(0.5, 1, 2)
    solid.export(tmp_path / "a.dae")
    shape = Shape.load(tmp_path / "a.dae")
    assert shape.watertight
    np.testing.assert_allclose(np.ptp(shape.vertices, axis=0), solid.extents, rtol=1e-6)


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damaged_files_give_a_mesh_or_one_error(data: st.DataObject, tmp_path: Path) -> None:
    whole = bytearray(interleaved() if data.draw(st.booleans()) else collada())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(whole) - 1))
        whole[place] = data.draw(st.sampled_from([32, 34, 35, 45, 46, 48, 57, 60, 62, 97]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            mesh = read(tmp_path, "a.dae", bytes(whole))
        except ValueError as error:
            assert_one_line(error)
        else:
            assert mesh.faces.max() < len(mesh.vertices)
