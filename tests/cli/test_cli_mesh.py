"""``fgenv mesh``: the report as text and as JSON, the picture, and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from support.mesh_files import MeshCase, mesh_cases
from support.shell import Shell

from fgenv.collision import Shape

CASES = mesh_cases()


def test_the_report_is_that_of_the_shape(shell: Shell, tmp_path: Path) -> None:
    file = tmp_path / "box.obj"
    trimesh.creation.box((1.0, 2.0, 3.0)).export(file)
    code, out, err = shell("mesh", file, "--scale", 0.5)
    assert (code, err) == (0, "")
    assert out == f"{Shape.load(file, scale=0.5).report}\n"
    data = shell.json("mesh", file, "--scale", 0.5)
    assert data["extents"] == [0.5, 1.0, 1.5]
    assert (data["volume"], data["area"]) == (pytest.approx(0.75), pytest.approx(5.5))
    assert (data["file"]["format"], data["file"]["scale"], data["warnings"]) == ("OBJ", 0.5, [])


def test_warnings_are_reported(shell: Shell, tmp_path: Path) -> None:
    file = tmp_path / "large.stl"
    trimesh.creation.box((300.0, 200.0, 100.0)).export(file)
    _, out, _ = shell("mesh", file)
    assert "warning: mesh 'large'" in out
    assert "scale=0.001" in out


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_the_picture_does_not_depend_on_the_unit(shell: Shell, tmp_path: Path, size: float) -> None:
    file = tmp_path / "box.obj"
    trimesh.creation.box((1.0, 2.0, 1.0)).export(file)
    reference, scaled = tmp_path / "a.png", tmp_path / "b.png"
    shell("mesh", file, "--picture", reference)
    shell("mesh", file, "--scale", size, "--picture", scaled)
    with Image.open(reference) as one, Image.open(scaled) as other:
        assert one.size == (640, 480)
        pixels = [np.asarray(image.convert("RGB"), dtype=int) for image in (one, other)]
    assert len(np.unique(pixels[0].reshape(-1, 3), axis=0)) > 10  # it is not empty
    assert (np.abs(pixels[0] - pixels[1]).max(axis=2) > 8).mean() < 0.01


@pytest.mark.parametrize("case", CASES[::9], ids=lambda case: case.name)
def test_constructs_of_all_formats_are_reported(
    shell: Shell, tmp_path: Path, case: MeshCase
) -> None:
    file = tmp_path / case.name
    file.write_bytes(case.content)
    data = shell.json("mesh", file)
    assert data["area"] == pytest.approx(case.area, rel=1e-5)
    assert data["extents"] == pytest.approx(list(case.extents), rel=1e-5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("none.stl", "none.stl does not exist, expected a mesh file"),
        ("page.stl", "page.stl"),
        ("box.obj --picture p.jpg", "--picture: got p.jpg, expected a name that ends in .png"),
        ("box.obj --scale 0", "--scale: got 0.0, expected a factor over 0"),
        ("box.obj --method exakt", "--method: got 'exakt'; did you mean 'exact'?"),
    ],
)
def test_errors_are_one_line(shell: Shell, arguments: str, message: str) -> None:
    trimesh.creation.box().export("box.obj")
    Path("page.stl").write_text("<!DOCTYPE html><html>not found</html>")
    assert message in shell.refuses("mesh", *arguments.split())
