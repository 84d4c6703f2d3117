"""Mesh files of every construct are read as they specify, and reported."""

from __future__ import annotations

import gzip
import json
import os
import pickle
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.mesh_files import (
    MeshCase,
    binary_stl,
    facets,
    mesh_cases,
    obj,
    off,
    ply_faces,
    ply_header,
    ply_vertices,
    prism,
    prism_triangles,
)

from fgenv.bench.common.solids import ball, box
from fgenv.collision import MeshWarning, Shape
from fgenv.collision.mesh_files import FileMesh, Unit, read_mesh_file, text, unit_warning

CASES = mesh_cases()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_construct(case: MeshCase, tmp_path: Path) -> None:
    """Area, volume and extents are those of the solid, without a warning."""
    path = tmp_path / case.name
    path.write_bytes(case.content)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = Shape.load(path).report
    assert report.area == pytest.approx(case.area)
    assert report.volume == pytest.approx(case.volume)
    assert report.extents == pytest.approx(case.extents)
    assert report.watertight
    assert report.shells == 1
    assert (report.vertices, report.faces) == (12, 20)
    assert (report.feature_points, report.feature_edges) == (12, 18)
    assert report.file is not None
    assert (report.file.polygons, report.file.nonplanar) == (case.polygons, 0)
    assert case.note in " ".join(report.notes)
    assert bool(report.notes) == bool(case.note)


def test_cases_have_different_names() -> None:
    assert len({case.name.lower() for case in CASES}) == len(CASES)


# Reports


def test_a_report_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "part.obj"
    path.write_text(obj(1000 * prism()[0], prism()[1]) + "v 9 9 9\nf 1 1 2\nl 1 2\n")
    with pytest.warns(MeshWarning, match="repaired"):
        shape = Shape.load(path, scale=0.001)
    report = shape.report
    assert report.file is not None
    assert report.file.format == "OBJ"
    assert (report.file.unit, report.file.up, report.file.scale) == (None, None, 0.001)
    assert (report.vertices_in, report.vertices) == (report.file.vertices, 12) == (13, 12)
    assert (report.faces_in, report.faces) == (report.file.faces, 20) == (21, 20)
    assert report.repairs["unused_vertices"] == 1
    assert report.repairs["degenerate_faces"] == 1
    assert report.volume == pytest.approx(3.0)
    text = str(report)
    for words in ("part", "OBJ", "0.001", "13 -> 12", "21 -> 20", "14 m^2", "3 m^3", "polylines"):
        assert words in text
    data = json.loads(json.dumps(report.as_dict()))
    assert data["file"]["format"] == "OBJ"
    assert data["extents"] == pytest.approx([2, 2, 1])


def test_a_report_of_arrays() -> None:
    report = Shape(*ball(1.0), name="ball").report
    assert report.file is None
    assert report.volume == pytest.approx(4 / 3 * np.pi, rel=0.1)
    assert report.watertight
    assert str(report).startswith("ball\n")
    assert "format" not in str(report)


def test_a_report_of_an_open_mesh_has_no_volume() -> None:
    vertices, faces = box(1.0)
    with pytest.warns(MeshWarning):
        report = Shape(vertices, faces[:-1]).report
    assert report.volume is None
    assert not report.watertight
    assert "volume      none" in str(report)


def test_a_report_of_a_mesh_inside_out() -> None:
    vertices, faces = box(1.0)
    report = Shape(vertices, faces[:, ::-1]).report
    assert report.volume is not None
    assert report.volume < 0
    assert "inside out" in " ".join(report.notes)


def test_shells_are_counted() -> None:
    vertices, faces = box(1.0)
    far = np.vstack([vertices, vertices + 5, vertices + 10])
    assert Shape(far, np.vstack([faces, faces + 8, faces + 16])).report.shells == 3


def test_pickled_shapes_keep_the_part_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "part.off"
    path.write_text(off(*prism()))
    shape = Shape.load(path)
    again = pickle.loads(pickle.dumps(shape))
    assert again.report.file == shape.report.file
    assert again.report.volume == shape.report.volume


# Units


def test_sizes_that_are_implausible_in_meters(tmp_path: Path) -> None:
    vertices, faces = prism_triangles()
    for factor, remedy in ((150.0, "scale=0.001"), (1e-5, "scale=1000")):
        path = tmp_path / f"part{factor}.stl"
        path.write_bytes(binary_stl(factor * vertices, faces))
        with pytest.warns(MeshWarning, match=remedy) as caught:
            Shape.load(path, name="link")
        (warning,) = caught
        assert "link" in str(warning.message)
        assert warning.filename == __file__
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            Shape.load(path, scale=0.5)  # the caller states the unit
    vertices = 30 * vertices
    path.write_bytes(binary_stl(vertices, faces))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Shape.load(path)


def test_stated_units_are_plausible_at_any_size() -> None:
    vertices, faces = prism_triangles()
    mesh = FileMesh("3MF", 150 * vertices, faces)
    assert unit_warning(mesh, 1.0) is not None
    stated = FileMesh("3MF", 150 * vertices, faces, unit=Unit("millimeter", 0.001))
    assert unit_warning(stated, 1.0) is None


@pytest.mark.parametrize("size", [1e-6, 1e6])
@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off"])
@pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
def test_very_small_and_large_meshes(size: float, suffix: str, tmp_path: Path) -> None:
    vertices, polygons = prism()
    path = tmp_path / f"part.{suffix}"
    if suffix == "stl":
        path.write_text(f"solid\n{facets(size * vertices, prism_triangles()[1])}endsolid\n")
    elif suffix == "ply":
        head = [("vertex", 12, ("float x", "float y", "float z")),
                ("face", 8, ("list uchar int vertex_indices",))]  # fmt: skip
        kind = "binary_little_endian"
        body = ply_vertices(size * vertices, kind) + ply_faces(polygons, kind)
        path.write_bytes(ply_header(kind, head) + body)
    else:
        path.write_text((obj if suffix == "obj" else off)(size * vertices, polygons))
    report = Shape.load(path).report
    assert report.area == pytest.approx(14 * size**2)
    assert report.volume == pytest.approx(3 * size**3)
    assert report.faces == 20


# Paths


@pytest.mark.parametrize(
    "name", ["with space.stl", "Größe.stl", "部品.STL", "a%20b.Stl", "dots.in.name.stl", "-x.stl"]
)
def test_names_of_files(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "a folder ä"
    folder.mkdir()
    (folder / name).write_bytes(binary_stl(*prism_triangles()))
    shape = Shape.load(folder / name)
    assert shape.name == Path(name).stem
    assert len(shape.faces) == 20


def test_the_name_of_a_packed_file(tmp_path: Path) -> None:
    path = tmp_path / "part.v2.stl.gz"
    path.write_bytes(gzip.compress(binary_stl(*prism_triangles())))
    assert Shape.load(path).name == "part.v2"


def test_a_link_to_a_file(tmp_path: Path) -> None:
    (tmp_path / "part.stl").write_bytes(binary_stl(*prism_triangles()))
    (tmp_path / "link.stl").symlink_to("part.stl")
    assert len(Shape.load(tmp_path / "link.stl").faces) == 20


def test_the_order_of_faces_and_vertices_is_kept(tmp_path: Path) -> None:
    vertices, faces = prism_triangles()
    path = tmp_path / "part.obj"
    path.write_text(obj(vertices, faces.tolist()))
    mesh = read_mesh_file(path)
    assert (mesh.vertices == vertices).all()
    assert (mesh.faces == faces).all()


@settings(max_examples=30)
@given(st.lists(st.floats(-1e6, 1e6, width=32), min_size=9, max_size=9))
def test_coordinates_are_exact(values: list[float]) -> None:
    """Every float32 comes back to the last bit in each format."""
    vertices = np.array(values).reshape(3, 3)
    face = [[0, 1, 2]]
    kind = "binary_big_endian"
    xyz = ("float x", "float y", "float z")
    head = ply_header(kind, [("vertex", 3, xyz), ("face", 1, ("list uchar int vertex_index",))])
    contents = {
        "stl": binary_stl(vertices, np.array(face)),
        "text.stl": f"solid\n{facets(vertices, np.array(face))}endsolid\n".encode(),
        "obj": obj(vertices, face).encode(),
        "off": off(vertices, face).encode(),
        "ply": head + ply_vertices(vertices, kind) + ply_faces(face, kind),
    }
    for suffix, content in contents.items():
        path = Path(os.environ.get("TMPDIR", "/tmp")) / f"fgenv-exact-{os.getpid()}.{suffix}"
        try:
            path.write_bytes(content)
            mesh = read_mesh_file(path)
        finally:
            path.unlink()
        assert (mesh.vertices[mesh.faces[0]].astype(np.float32) == vertices).all()


def test_formats_are_listed_by_the_error_of_an_unknown_one(tmp_path: Path) -> None:
    path = tmp_path / "part.step"
    path.write_bytes(b"ISO-10303-21;")
    with pytest.raises(ValueError, match=re.escape(".step")) as caught:
        Shape.load(path)
    for words in (".stl", ".obj", ".ply", ".off", ".glb", ".dae", ".3mf", ".gz", "CAD"):
        assert words in str(caught.value)


# Long work


def test_progress_of_a_text_and_of_the_tree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(text, "CHUNK", 1000)
    path = tmp_path / "ball.obj"
    vertices, faces = ball(1.0, subdivisions=6)
    path.write_text(obj(vertices, faces.tolist()))
    calls: list[tuple[str, float]] = []
    shape = Shape.load(path, progress=lambda stage, share: calls.append((stage, share)))
    assert len(shape.faces) == len(faces)
    assert [stage for stage, _ in calls] == sorted((stage for stage, _ in calls), reverse=True)
    for stage in ("reading", "building"):
        shares = [share for name, share in calls if name == stage]
        assert shares == sorted(shares)
        assert all(0 <= share <= 1 for share in shares)
    assert sum(name == "reading" for name, _ in calls) > 100


def test_chunks_of_a_text_do_not_matter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Facets, faces and line numbers across the borders of chunks."""
    for case in CASES:
        if case.name.lower().endswith((".stl", ".obj", ".off")):
            path = tmp_path / case.name
            path.write_bytes(case.content)
            whole = read_mesh_file(path)
            for size in (1, 37):
                monkeypatch.setattr(text, "CHUNK", size)
                parts = read_mesh_file(path)
                assert (parts.vertices == whole.vertices).all()
                assert (parts.faces == whole.faces).all()
                assert parts.notes == whole.notes
            monkeypatch.undo()
    monkeypatch.setattr(text, "CHUNK", 10)
    path = tmp_path / "bad.obj"
    path.write_text(obj(*prism()) + "f 1 \\\n 2 3\nf 1 2 99\n")
    with pytest.raises(ValueError, match="line 23: got the vertex index 99"):
        read_mesh_file(path)


def test_an_exception_in_progress_ends_the_construction() -> None:
    """As the native code runs without the lock of Python, the exception crosses it."""
    vertices, faces = ball(1.0, subdivisions=6)

    def stop(share: float) -> None:
        raise RuntimeError("stop")

    with pytest.raises(RuntimeError, match="stop"):  # it is called each 20 ms
        Shape(vertices, faces, progress=stop)
