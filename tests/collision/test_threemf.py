"""3MF files: each construct with known measures, each fault with its reason."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.scene_files import (
    RELATIONS,
    assert_box,
    assert_one_line,
    box,
    box_object,
    measures,
    model,
    numbers,
    read,
    threemf,
    zipped,
)

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.collision.mesh_files import scene_parts

VERTICES, FACES = box()
METER = 'unit="meter"'
SHIFT = "1 0 0 0 1 0 0 0 1 5 6 7"
BEAMS = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
SECURE = "http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/07"


def group(*components: str, name: str = "2", attributes: str = "") -> str:
    return (
        f'<object id="{name}" {attributes}><components>{"".join(components)}</components></object>'
    )


def component(name: str, transform: str = "", more: str = "") -> str:
    placed = f'transform="{transform}"' if transform else ""
    return f'<component objectid="{name}" {placed} {more}/>'


def text(pose: Floats) -> str:
    """A matrix (4, 4) as the twelve numbers of the format."""
    return numbers(pose[:3].T)


UP_DOWN = group(component("1", SHIFT)) + group(
    component("2", "1 0 0 0 1 0 0 0 1 -5 -6 -7"), name="3"
)
OTHER = model(box_object("7"), build="")
PATH = 'p:path="/3D/other.model"'
BOXES: dict[str, Callable[[], bytes]] = {
    "one object": lambda: threemf(model(box_object())),
    "shifted": lambda: threemf(model(box_object(), f'<item objectid="1" transform="{SHIFT}"/>')),
    "mirrored": lambda: threemf(
        model(box_object(), '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>')
    ),
    "components": lambda: threemf(model(box_object() + UP_DOWN, '<item objectid="3"/>')),
    "surface": lambda: threemf(model(box_object(attributes='type="surface"'))),
    "item in another part": lambda: threemf(
        model("", f'<item objectid="7" {PATH}/>'), other=OTHER
    ),
    "component in another part": lambda: threemf(
        model(group(component("7", more=PATH)), '<item objectid="2"/>'), other=OTHER
    ),
    "production is required": lambda: threemf(
        model(box_object(), attributes=f'{METER} requiredextensions="p"')
    ),
    "names of parts in upper case": lambda: zipped(
        {"_RELS/.rels": RELATIONS, "3d/3DModel.model": model(box_object())}
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BOXES)
def test_every_construct_gives_the_box(name: str, tmp_path: Path) -> None:
    mesh = read(tmp_path, "a.3mf", BOXES[name]())
    assert_box(mesh)
    assert mesh.up is None
    assert mesh.notes == ()
    moved = VERTICES + [5, 6, 7] if name == "shifted" else VERTICES
    if name != "mirrored":
        np.testing.assert_array_equal(mesh.vertices, moved)


@pytest.mark.parametrize(
    ("unit", "meters"),
    [
        ("", 1e-3),
        ('unit="micron"', 1e-6),
        ('unit="millimeter"', 1e-3),
        ('unit="centimeter"', 1e-2),
        ('unit="inch"', 0.0254),
        ('unit="foot"', 0.3048),
        ('unit="meter"', 1.0),
    ],
)
def test_units(unit: str, meters: float, tmp_path: Path) -> None:
    mesh = read(tmp_path, "a.3mf", threemf(model(box_object(), attributes=unit)))
    assert_box(mesh, scale=meters)
    assert mesh.unit is not None
    assert mesh.unit.meters == meters


def test_several_items_and_skipped_objects(tmp_path: Path) -> None:
    supports = box_object("5", 'type="support"') + box_object("6", 'type="solidsupport"')
    resources = box_object() + UP_DOWN + supports + box_object("9")
    items = "".join(f'<item objectid="{i}"/>' for i in (1, 3, 5, 6))
    mesh = read(tmp_path, "a.3mf", threemf(model(resources, items)))
    assert_box(mesh, copies=2)
    notes = " ".join(mesh.notes)
    for word in ("type support", "type solidsupport", "1 objects"):
        assert word in notes


def test_settings_of_slicers_are_noted(tmp_path: Path) -> None:
    parts = {"_rels/.rels": RELATIONS, "3D/3dmodel.model": model(box_object())}
    mesh = read(tmp_path, "a.3mf", zipped({**parts, "Metadata/Slic3r_PE_model.config": "..."}))
    assert_box(mesh)
    assert "slicer" in " ".join(mesh.notes)


def edited(old: str, new: str) -> bytes:
    content = model(box_object())
    assert old in content
    return threemf(content.replace(old, new, 1))


def required(prefix: str, namespace: str) -> bytes:
    attributes = f'{METER} xmlns:{prefix}="{namespace}" requiredextensions="p {prefix}"'
    return threemf(model(box_object(), attributes=attributes))


CYCLE = group(component("3")) + group(component("2"), name="3")
ENCRYPTED = RELATIONS.replace(
    "<Relationship ",
    '<Relationship Id="e" Target="/3D/3dmodel.model" Type='
    '"http://schemas.openxmlformats.org/package/2006/relationships/encryptedfile"/><Relationship ',
)
BOMB = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">]>'
LATTICE = f'<b:beamlattice xmlns:b="{BEAMS}"/>'
FAULTS: dict[str, tuple[bytes, str]] = {
    "unit": (threemf(model(box_object(), attributes='unit="mile"')), "'mile'.*millimeter"),
    "cycle": (threemf(model(CYCLE, '<item objectid="2"/>')), "inside itself"),
    "missing object": (edited('objectid="1"', 'objectid="4"'), "object '4'"),
    "missing component": (threemf(model(group(component("9")), '<item objectid="2"/>')), "'9'"),
    "missing part": (threemf(model("", f'<item objectid="7" {PATH}/>')), "no part '3D/other"),
    "empty build": (threemf(model(box_object(), "")), "without items"),
    "two objects of one id": (threemf(model(box_object() * 2)), "unique"),
    "type": (threemf(model(box_object(attributes='type="ghost"'))), "'ghost'"),
    "transform": (edited("<item ", '<item transform="1 0 0" '), "12 finite"),
    "transform of NaN": (edited("<item ", f'<item transform="{"nan " * 12}" '), "12 finite"),
    "vertex out of range": (edited('v1="0"', 'v1="8"'), "vertex 8"),
    "negative vertex": (edited('v1="0"', 'v1="-1"'), "vertex -1"),
    "half a vertex": (edited('v1="0"', 'v1="0.5"'), "vertex 0.5"),
    "NaN index": (edited('v1="0"', 'v1="nan"'), "vertex nan"),
    "NaN vertex": (edited('x="0.0"', 'x="nan"'), "nan"),
    "word": (edited('x="0.0"', 'x="zero"'), "'zero', '0.0', '0.0'. for x, y, z"),
    "missing coordinate": (edited('x="0.0"', ""), "no value for x"),
    "no triangles": (threemf(model('<object id="1"><mesh/></object>')), "no faces"),
    "empty object": (threemf(model('<object id="1"/>')), "no content"),
    "beam lattice": (threemf(model(box_object(extra=LATTICE))), "beamlattice"),
    "volume": (edited("<mesh>", "<levelset/><mesh>"), "levelset"),
    "slices": (edited("<object ", '<object p:slicestackid="4" '), "slices"),
    "required beam lattice": (required("b", BEAMS), "beam lattice"),
    "required encryption": (required("sc", SECURE), "encryption"),
    "required unknown": (required("w", "http://example.com/warp"), "example.com/warp"),
    "encrypted": (zipped({"_rels/.rels": ENCRYPTED, "3D/3dmodel.model": "?"}), "encrypted"),
    "no relations": (zipped({"3D/3dmodel.model": model(box_object())}), "_rels/.rels"),
    "no start part": (zipped({"_rels/.rels": "<Relationships/>"}), "0 start parts"),
    "no model": (zipped({"_rels/.rels": RELATIONS, "3D/3dmodel.model": "<a/>"}), "<a>"),
    "entities": (edited("<model", f"{BOMB}<model"), "document type"),
    "truncated XML": (edited("</model>", ""), "malformed XML"),
    "truncated zip": (threemf(model(box_object()))[:-30], "zip"),
    "not a zip": (b"solid a", "zip"),
    "zip bomb": (threemf(model(box_object()) + " " * (64 << 20)), "unpacks to"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_refused_with_their_reason(name: str, tmp_path: Path) -> None:
    content, reason = FAULTS[name]
    with pytest.raises(ValueError, match=reason) as caught:
        read(tmp_path, "bad.3mf", content)
    assert "bad.3mf" in str(caught.value)
    assert_one_line(caught.value)


def test_components_of_components_are_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene_parts, "MAX_NODES", 1000)
    groups = [group(component(str(i)) * 2, name=str(i + 1)) for i in range(1, 30)]
    content = threemf(model(box_object() + "".join(groups), '<item objectid="30"/>'))
    with pytest.raises(ValueError, match="smaller scene"):
        read(tmp_path, "a.3mf", content)


def test_a_small_file_places_a_bounded_number_of_faces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each group is twice the one before: 2^n boxes in a file whose size is about n."""
    groups = [group(component(str(i)) + component(str(i), SHIFT), name=str(i + 1)) for i in (1, 2)]
    for i in range(3, 9):
        groups.append(group(component(str(i)) * 2, name=str(i + 1)))
    content = threemf(model(box_object() + "".join(groups), '<item objectid="9"/>'))
    assert_box(read(tmp_path, "a.3mf", content), copies=256)
    monkeypatch.setattr(scene_parts, "MIN_ITEMS", 1000)
    with pytest.raises(ValueError, match="over 1000 vertices or faces"):
        read(tmp_path, "a.3mf", content)


NUMBER = st.floats(-2, 2).map(lambda x: round(x, 3))
SCALE = st.sampled_from([-2.0, -1.0, 0.5, 1.0, 3.0])


@st.composite
def poses(draw: st.DrawFn) -> Floats:
    pose = np.eye(4)
    turn = Rotation.from_euler("xyz", draw(st.tuples(NUMBER, NUMBER, NUMBER)))
    pose[:3, :3] = turn.as_matrix() * draw(st.tuples(SCALE, SCALE, SCALE))
    pose[:3, 3] = draw(st.tuples(NUMBER, NUMBER, NUMBER))
    return pose


@settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
@given(placed=st.lists(st.lists(poses(), min_size=1, max_size=3), min_size=1, max_size=4))
def test_components_place_every_box(placed: list[list[Floats]], tmp_path: Path) -> None:
    """Each level places the one below it at several poses."""
    resources, expected = box_object("0"), [np.eye(4)]
    for level, below in enumerate(placed):
        components = [component(str(level), text(pose)) for pose in below]
        resources += group(*components, name=str(level + 1))
        expected = [pose @ inner for pose in below for inner in expected]
    mesh = read(tmp_path, "a.3mf", threemf(model(resources, f'<item objectid="{len(placed)}"/>')))
    boxes = mesh.vertices.reshape(-1, 8, 3)
    assert len(boxes) == len(expected)
    for found, pose in zip(boxes, expected, strict=True):
        moved = VERTICES @ pose[:3, :3].T + pose[:3, 3]
        np.testing.assert_allclose(found, moved, atol=1e-10 * max(1, np.abs(moved).max()))
    volume = sum(6 * abs(np.linalg.det(pose[:3, :3])) for pose in expected)
    np.testing.assert_allclose(measures(mesh)[1], volume, rtol=1e-6)


def test_trimesh_writes_the_same(tmp_path: Path) -> None:
    solid = trimesh.creation.annulus(0.5, 1, 2)
    solid.export(tmp_path / "a.3mf")
    shape = Shape.load(tmp_path / "a.3mf", scale=1000)  # trimesh writes millimeters
    assert shape.watertight
    np.testing.assert_allclose(np.ptp(shape.vertices, axis=0), solid.extents, rtol=1e-6)


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damaged_files_give_a_mesh_or_one_error(data: st.DataObject, tmp_path: Path) -> None:
    whole = bytearray(model(box_object() + UP_DOWN, '<item objectid="3"/>').encode())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(whole) - 1))
        whole[place] = data.draw(st.sampled_from([32, 34, 45, 46, 48, 57, 60, 62, 97]))
    content = zipped({"_rels/.rels": RELATIONS, "3D/3dmodel.model": bytes(whole)})
    try:
        mesh = read(tmp_path, "a.3mf", content)
    except ValueError as error:
        assert_one_line(error)
    else:
        assert mesh.faces.max() < len(mesh.vertices)
