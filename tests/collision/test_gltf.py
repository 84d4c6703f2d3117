"""glTF files: each construct with known measures, each fault with its reason."""

from __future__ import annotations

import gzip
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.scene_files import (
    QUADS,
    GltfFile,
    assert_box,
    assert_one_line,
    box,
    glb,
    measures,
    one_box,
    read,
)

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.collision.mesh_files import scene_parts

VERTICES, FACES = box()
SLIGHT = 0.1 * np.arange(24).reshape(8, 3)


def mesh(file: GltfFile, *primitives: dict[str, Any], **more: Any) -> GltfFile:
    """The scene of one mesh of these primitives."""
    return file.scene({"mesh": file.add("meshes", primitives=list(primitives), **more)})


def primitive(file: GltfFile, positions: Any, corners: Any, **more: Any) -> dict[str, Any]:
    attributes = {"POSITION": file.accessor(positions, "VEC3")}
    return {"attributes": attributes, "indices": file.accessor(corners, "SCALAR", "u1"), **more}


def unindexed() -> GltfFile:
    file = GltfFile()
    return mesh(
        file, {"attributes": {"POSITION": file.accessor(VERTICES[FACES].reshape(-1, 3), "VEC3")}}
    )


def quads(mode: int, order: list[int]) -> GltfFile:
    """Each side of the box as a strip or a fan."""
    file = GltfFile()
    return mesh(file, *(primitive(file, VERTICES, quad[order], mode=mode) for quad in QUADS))


def long_strip() -> GltfFile:
    """Four sides as one strip of ten corners, the ends as two fans."""
    file = GltfFile()
    ring = np.array([4, 0, 5, 1, 7, 3, 6, 2, 4, 0])
    fans = [primitive(file, VERTICES, QUADS[k], mode=6) for k in (0, 1)]
    return mesh(file, primitive(file, VERTICES, ring, mode=5), *fans)


def interleaved() -> GltfFile:
    file = GltfFile()
    position = file.accessor(VERTICES, "VEC3", stride=28)
    return mesh(
        file,
        {
            "attributes": {"POSITION": position},
            "indices": file.accessor(FACES.ravel(), "SCALAR", "u4"),
        },
    )


def sparse(base: bool) -> GltfFile:
    """The positions of the box, all but the first replaced by sparse values."""
    file = GltfFile()
    item = {"componentType": 5126, "count": 8, "type": "VEC3"}
    if base:
        item["bufferView"] = file.view((VERTICES + 7).astype("<f4").tobytes())
    first = 0 if base else 1  # the first vertex is zero
    places, values = np.arange(first, 8), VERTICES[first:]
    indices = {"bufferView": file.view(places.astype("<u2").tobytes()), "componentType": 5123}
    view = {"bufferView": file.view(values.astype("<f4").tobytes())}
    position = file.add(
        "accessors", **item, sparse={"count": len(places), "indices": indices, "values": view}
    )
    corners = file.accessor(FACES.ravel(), "SCALAR", "u1")
    return mesh(file, {"attributes": {"POSITION": position}, "indices": corners})


def quantized(code: str, normalized: bool) -> GltfFile:
    """Integer positions, with the scale in the node (KHR_mesh_quantization)."""
    largest = np.iinfo(code).max
    stored = np.round(VERTICES / 3 * largest)
    file = GltfFile()
    item = primitive(file, VERTICES, FACES.ravel())
    item["attributes"]["POSITION"] = file.accessor(
        stored,
        "VEC3",
        code,
        stride=4 * (3 * np.dtype(code).itemsize // 4 + 1),
        normalized=normalized,
    )
    mesh(file, item)
    file.content["nodes"][0]["scale"] = [3.0 if normalized else 3.0 / largest] * 3
    file.content["extensionsRequired"] = ["KHR_mesh_quantization"]
    return file


def morphed(weights: str) -> GltfFile:
    """A squashed box; two targets restore it, at weights of the mesh or of the node."""
    file = GltfFile()
    targets = [
        {"POSITION": file.accessor(2 * SLIGHT, "VEC3")},
        {"POSITION": file.accessor(SLIGHT, "VEC3")},
    ]
    item = primitive(file, VERTICES - SLIGHT, FACES.ravel(), targets=targets)
    mesh(file, item, weights=[0.25, 0.5] if weights == "mesh" else [9, 9])
    if weights == "node":
        file.content["nodes"][0]["weights"] = [0, 1]
    return file


def skinned_box() -> GltfFile:
    """A box whose upper half follows a second joint; the transform of its node has no effect."""
    file = GltfFile()
    item = primitive(file, VERTICES - [0, 0, 5], FACES.ravel())
    upper = VERTICES[:, 2] > 0
    joints = np.zeros((8, 4))
    joints[:, 0] = upper
    item["attributes"]["JOINTS_0"] = file.accessor(joints, "VEC4", "u1")
    item["attributes"]["WEIGHTS_0"] = file.accessor(
        np.tile([255, 0, 0, 0], (8, 1)), "VEC4", "u1", normalized=True
    )
    inverse = np.tile(np.eye(4), (2, 1, 1))
    inverse[:, 2, 3] = 5.0, 4.0  # the second joint is one higher than when it was bound
    matrices = file.accessor(inverse.transpose(0, 2, 1).reshape(2, 16), "MAT4")
    mesh(file, item)
    file.content["nodes"][0] |= {"skin": 0, "translation": [100, 0, 0], "scale": [-7, 7, 7]}
    file.content["nodes"] += [{"children": [2]}, {"translation": [0, 0, 1]}]
    file.content["scenes"][0]["nodes"] = [0, 1]
    file.add("skins", joints=[1, 2], inverseBindMatrices=matrices)
    return file


def shared_vertices() -> GltfFile:
    """Six primitives that share one accessor of positions."""
    file = GltfFile()
    position = file.accessor(VERTICES, "VEC3")
    corners = [file.accessor(quad[[0, 1, 2, 0, 2, 3]], "SCALAR", "u2") for quad in QUADS]
    return mesh(file, *({"attributes": {"POSITION": position}, "indices": i} for i in corners))


def with_texture() -> GltfFile:
    file = one_box()
    file.add("images", uri="missing.png")
    file.add("textures", source=0)
    file.add("materials", pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
    file.content["meshes"][0]["primitives"][0]["material"] = 0
    return file


def second_scene() -> GltfFile:
    file = one_box(scale=[9, 9, 9])
    file.scene({"mesh": 0})
    file.content["scene"] = 1
    return file


def no_scene() -> GltfFile:
    file = GltfFile()
    file.content["nodes"] = [{"children": [1]}, {"mesh": file.box_mesh()}]
    return file


def turned_back() -> GltfFile:
    """A box under a rotation and a matrix that cancel each other."""
    turn = Rotation.from_rotvec([0.3, -0.5, 0.7])
    back = np.eye(4)
    back[:3, :3] = turn.inv().as_matrix()
    file = GltfFile()
    file.add("nodes", rotation=turn.as_quat().tolist(), children=[1])
    file.add("nodes", matrix=back.T.ravel().tolist(), mesh=file.box_mesh())
    file.add("scenes", nodes=[0])
    return file


def draco_fallback() -> GltfFile:
    file = one_box()
    file.content["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    extension = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    file.content["meshes"][0]["primitives"][0]["extensions"] = extension
    return file


BOXES: dict[str, Callable[[], GltfFile]] = {
    "u1": lambda: (f := GltfFile()).scene({"mesh": f.box_mesh("u1")}),
    "u2": one_box,
    "u4": lambda: (f := GltfFile()).scene({"mesh": f.box_mesh("u4")}),
    "unindexed": unindexed,
    "strips": lambda: quads(5, [0, 1, 3, 2]),
    "fans": lambda: quads(6, [0, 1, 2, 3]),
    "long strip": long_strip,
    "interleaved": interleaved,
    "sparse": lambda: sparse(True),
    "sparse from zeros": lambda: sparse(False),
    "normalized i1": lambda: quantized("i1", True),
    "normalized u1": lambda: quantized("u1", True),
    "normalized i2": lambda: quantized("i2", True),
    "normalized u2": lambda: quantized("u2", True),
    "whole u2": lambda: quantized("u2", False),
    "whole i1": lambda: quantized("i1", False),
    "weights of the mesh": lambda: morphed("mesh"),
    "weights of the node": lambda: morphed("node"),
    "skin": skinned_box,
    "shared vertices": shared_vertices,
    "missing texture": with_texture,
    "second scene": second_scene,
    "no scene": no_scene,
    "turned back": turned_back,
    "mirrored": lambda: one_box(scale=[-1, 1, 1]),
    "mirrored matrix": lambda: one_box(matrix=np.diag([1, 1, -1, 1.0]).ravel().tolist()),
    "draco with fallback": draco_fallback,
}


@pytest.mark.parametrize("name", BOXES)
def test_every_construct_gives_the_box(name: str, tmp_path: Path) -> None:
    file = BOXES[name]()
    error = 1e-6
    if name.startswith(("normalized", "whole")):
        error = 0.06 if "1" in name else 1e-4  # 8 or 16 bits
    for mesh in (read(tmp_path, "a.glb", file.glb()), read(tmp_path, "a.gltf", file.text())):
        assert_box(mesh, rtol=error)
        assert (mesh.unit and mesh.unit.meters, mesh.up) == (1.0, "y")


def test_instances_are_copies(tmp_path: Path) -> None:
    file = GltfFile()
    index = file.box_mesh()
    offsets = file.accessor([[0, 0, 0], [5, 0, 0], [0, 5, 0]], "VEC3")
    turns = file.accessor(np.tile([0, 0, 0, 127], (3, 1)), "VEC4", "i1", normalized=True)
    scales = file.accessor([[1, 1, 1], [-1, 1, 1], [1, 1, 1]], "VEC3")
    attributes = {"TRANSLATION": offsets, "ROTATION": turns, "SCALE": scales}
    extension = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    file.scene({"mesh": index}, {"mesh": index, "extensions": extension})
    file.content["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    mesh = read(tmp_path, "a.glb", file.glb())
    assert_box(mesh, copies=4)
    np.testing.assert_allclose(measures(mesh)[2], [5, 7, 3])


def test_lines_points_and_unused_parts_are_noted(tmp_path: Path) -> None:
    file = one_box()
    items = file.content["meshes"][0]["primitives"]
    items += [{**items[0], "mode": mode} for mode in (0, 1, 2, 3)]
    file.box_mesh()
    file.scene({"mesh": 0, "extensions": {"ACME_gravity": {}}})
    file.content["scene"] = 1
    file.add("animations", channels=[], samplers=[])
    mesh = read(tmp_path, "a.glb", file.glb())
    assert_box(mesh)
    text = " ".join(mesh.notes)
    for word in ("Points", "Lines", "1 meshes", "2 scenes", "Animations", "ACME_gravity"):
        assert word in text


def test_external_buffers_by_relative_paths(tmp_path: Path) -> None:
    file = one_box()
    folder = tmp_path / "the data"
    folder.mkdir()
    (folder / "büffer.bin").write_bytes(file.blob)
    assert_box(read(tmp_path, "a.gltf", file.text("the%20data/b%C3%BCffer.bin")))
    assert_box(read(folder, "b.gltf", file.text("../the%20data/büffer.bin")))
    assert_box(read(tmp_path, "c.glb.gz", gzip.compress(file.glb())))


def test_a_text_filled_with_zeros(tmp_path: Path) -> None:
    file = one_box()
    buffers = [{"byteLength": len(file.blob)}]
    text = json.dumps({"buffers": buffers, **file.content}).encode() + b"\0\0\0"
    assert_box(read(tmp_path, "a.glb", glb(text, bytes(file.blob))))


def changed(change: Callable[[GltfFile], Any]) -> bytes:
    """A GLB with one box after a change."""
    file = one_box()
    change(file)
    return file.glb()


def at(*keys: Any, **values: Any) -> bytes:
    """A GLB with one box, with values set on one of its items."""

    def change(file: GltfFile) -> None:
        item: Any = file.content
        for key in keys:
            item = item[key]
        item.update(values)

    return changed(change)


def draco() -> bytes:
    file = draco_fallback()
    for accessor in file.content["accessors"]:
        del accessor["bufferView"]
    return file.glb()


def uri(text: str) -> bytes:
    return one_box().text(text)


PRIMITIVE = ("meshes", 0, "primitives", 0)
GLB = one_box().glb()
FAULTS: dict[str, tuple[bytes, str]] = {
    "Draco, required": (at(extensionsRequired=["KHR_draco_mesh_compression"]), "Draco.*without"),
    "Draco, without fallback": (draco(), "Draco.*without"),
    "meshopt, required": (at(extensionsRequired=["EXT_meshopt_compression"]), "meshopt.*without"),
    "meshopt view": (at("bufferViews", 0, extensions={"EXT_meshopt_compression": {}}), "meshopt"),
    "unknown extension": (at(extensionsRequired=["ACME_warp"]), "ACME_warp"),
    "cycle": (
        changed(lambda f: f.content["nodes"].extend([{"children": [2]}, {"children": [1]}])),
        r"cycle in nodes\[1\]",
    ),
    "own child": (at("nodes", 0, children=[0]), r"nodes\[0\]"),
    "two parents": (
        changed(lambda f: f.content["nodes"].extend([{}, {"children": [1]}, {"children": [1]}])),
        "two parents",
    ),
    "child index": (at("nodes", 0, children=[7]), r"nodes\[7\]"),
    "child no index": (at("nodes", 0, children=[{}]), "nodes"),
    "mesh index": (at("nodes", 0, mesh=3), r"meshes\[3\]"),
    "negative index": (at("nodes", 0, mesh=-1), r"meshes\[-1\]"),
    "scene index": (at(scene=4), r"scenes\[4\]"),
    "root twice": (at("scenes", 0, nodes=[0, 0]), "twice"),
    "accessor index": (at(*PRIMITIVE, indices=9), r"accessors\[9\]"),
    "no position": (at(*PRIMITIVE, attributes={}), "POSITION"),
    "mode": (at(*PRIMITIVE, mode=7), "mode 7"),
    "indices are no triangles": (at("accessors", 1, count=35), "35 corners"),
    "vertex out of range": (at("accessors", 0, count=7), "index 7"),
    "float indices": (at("accessors", 1, componentType=5126, count=9), "unsigned"),
    "vector of two": (at("accessors", 0, type="VEC2"), "VEC2"),
    "component type": (at("accessors", 0, componentType=5130), "5130"),
    "count": (at("accessors", 0, count=10**9), "1000000000 elements"),
    "count is text": (at("accessors", 0, count="8"), "count"),
    "zeros without bound": (
        changed(
            lambda f: (
                f.content["accessors"][0].update(count=10**12)
                or f.content["accessors"][0].pop("bufferView")
            )
        ),
        "elements without a bufferView",
    ),
    "stride": (at("bufferViews", 0, byteStride=4), "byteStride of 4"),
    "view beyond its buffer": (at("bufferViews", 1, byteLength=10**6), "buffer"),
    "buffer too short": (at(buffers=[{"byteLength": 10**6}]), "truncated"),
    "no buffer": (one_box().text().replace(b'"uri"', b'"name"'), "no data"),
    "matrix and scale": (
        at("nodes", 0, matrix=np.eye(4).ravel().tolist(), scale=[1, 1, 1]),
        "matrix",
    ),
    "projection": (at("nodes", 0, matrix=[*np.eye(4).ravel().tolist()[:-1], 2]), "last row"),
    "rotation of zero": (at("nodes", 0, rotation=[0, 0, 0, 0]), "length 0"),
    "short translation": (at("nodes", 0, translation=[1, 2]), "3 finite numbers"),
    "infinite translation": (at("nodes", 0, translation=[1, 2, 1e999]), "Infinity|finite"),
    "overflow": (at("nodes", 0, scale=[1e308, 1e308, 1e308], translation=[1e308, 0, 0]), "inf"),
    "weights without targets": (at("nodes", 0, weights=[1]), "weights"),
    "version 1": (at("asset", version="1.0"), "2.0"),
    "later version": (at("asset", minVersion="2.1"), "2.1"),
    "no nodes": (at(nodes=[], scenes=[]), "no mesh in the scene"),
    "binary version": (GLB[:4] + b"\1" + GLB[5:], "version 1"),
    "truncated": (GLB[:-40], "truncated"),
    "truncated header": (GLB[:15], "15 bytes"),
    "bytes after the end": (GLB + b"1234", "after its end"),
    "chunk too long": (GLB[:12] + b"\xff\xff\xff\x7f" + GLB[16:], "chunk of"),
    "absolute path": (uri("/etc/passwd"), "relative"),
    "web address": (uri("https://example.com/a.bin"), "relative"),
    "missing buffer file": (uri("none.bin"), "none.bin does not exist"),
    "folder as buffer": (uri("."), "folder"),
    "bad base64": (uri("data:;base64,@@@"), "base64"),
    "no JSON": (b"{", "JSON"),
    "a list": (b"[]", "object"),
    "NaN": (b'{"asset": {"version": "2.0"}, "x": NaN}', "NaN"),
    "deep JSON": (b"[" * 10**5, "JSON"),
    "long number": (b'{"asset": {"version": "2.0"}, "scene": 1' + b"0" * 5000 + b"}", "JSON"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_refused_with_their_reason(name: str, tmp_path: Path) -> None:
    content, reason = FAULTS[name]
    file = "bad.glb" if content[:4] == b"glTF" else "bad.gltf"
    with pytest.raises(ValueError, match=reason) as caught:
        read(tmp_path, file, content)
    assert file in str(caught.value)
    assert_one_line(caught.value)


def test_a_pipe_as_buffer_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.bin")
    with pytest.raises(ValueError, match="pipe"):
        read(tmp_path, "a.gltf", one_box().text("pipe.bin"))


def test_a_joint_out_of_range_and_weights_of_two(tmp_path: Path) -> None:
    file = skinned_box()
    file.content["skins"][0]["joints"] = [1]
    with pytest.raises(ValueError, match="the joint 1"):
        read(tmp_path, "a.glb", file.glb())
    file = skinned_box()
    item = file.content["meshes"][0]["primitives"][0]["attributes"]
    item["WEIGHTS_0"] = file.accessor(np.tile([1, 1, 0, 0], (8, 1)), "VEC4")
    with pytest.raises(ValueError, match="add up to 1"):
        read(tmp_path, "a.glb", file.glb())


def test_instances_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene_parts, "MAX_ITEMS", 1000)
    file = GltfFile()
    file.scene(*[{"mesh": file.box_mesh()}] * 100)
    with pytest.raises(ValueError, match="smaller scene"):
        read(tmp_path, "a.glb", file.glb())


NUMBER = st.floats(-2, 2).map(lambda x: round(x, 3))
SCALE = st.sampled_from([-2.0, -1.0, 0.5, 1.0, 3.0])


@st.composite
def trees(draw: st.DrawFn) -> tuple[list[dict[str, Any]], list[Floats]]:
    """Nodes with their matrices in the scene, composed by SciPy."""
    nodes: list[dict[str, Any]] = []
    poses: list[Floats] = []
    for i in range(draw(st.integers(1, 7))):
        offset, factors = (
            draw(st.tuples(NUMBER, NUMBER, NUMBER)),
            draw(st.tuples(SCALE, SCALE, SCALE)),
        )
        turn = Rotation.from_euler("xyz", draw(st.tuples(NUMBER, NUMBER, NUMBER)))
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn.as_matrix() @ np.diag(factors), offset
        if draw(st.booleans()):
            node: dict[str, Any] = {"matrix": pose.T.ravel().tolist()}
        else:
            node = {"translation": offset, "rotation": turn.as_quat().tolist(), "scale": factors}
        parent = draw(st.integers(-1, i - 1))
        if parent >= 0:
            nodes[parent].setdefault("children", []).append(i)
            pose = poses[parent] @ pose
        nodes.append({**node, "mesh": 0, "parent": parent})
        poses.append(pose)
    return nodes, poses


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(tree=trees())
def test_node_trees_place_every_box(
    tree: tuple[list[dict[str, Any]], list[Floats]], tmp_path: Path
) -> None:
    nodes, poses = tree
    file = GltfFile()
    file.box_mesh()
    file.content["nodes"] = nodes
    file.add("scenes", nodes=[i for i, node in enumerate(nodes) if node["parent"] < 0])
    mesh = read(tmp_path, "a.glb", file.glb())
    expected = [VERTICES @ pose[:3, :3].T + pose[:3, 3] for pose in poses]
    scale = max(1.0, np.abs(expected).max())
    boxes = mesh.vertices.reshape(-1, 8, 3)
    assert len(boxes) == len(poses)
    for one in np.stack(expected):
        assert np.abs(boxes - one).max(axis=(1, 2)).min() < 1e-9 * scale
    volume = sum(6 * abs(np.linalg.det(pose[:3, :3])) for pose in poses)
    np.testing.assert_allclose(measures(mesh)[1], volume, rtol=1e-6)


def test_trimesh_reads_the_same_scene(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    solid = trimesh.creation.annulus(0.5, 1, 2)
    for seed in range(5):
        pose = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))
        scene.add_geometry(solid, transform=pose)
    scene.export(tmp_path / "a.glb")
    ours, theirs = Shape.load(tmp_path / "a.glb"), trimesh.load_mesh(tmp_path / "a.glb")
    assert ours.watertight
    np.testing.assert_allclose(np.ptp(ours.vertices, axis=0), theirs.extents)


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data(), text=st.booleans())
def test_damaged_files_give_a_mesh_or_one_error(
    data: st.DataObject, text: bool, tmp_path: Path
) -> None:
    whole = bytearray(skinned_box().text() if text else sparse(True).glb())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(whole) - 1))
        whole[place] = data.draw(st.sampled_from([0, 45, 48, 57, 91, 123, 255]))
    try:
        mesh = read(tmp_path, "a.gltf" if text else "a.glb", bytes(whole))
    except ValueError as error:
        assert_one_line(error)
    else:
        assert mesh.faces.max() < len(mesh.vertices)
