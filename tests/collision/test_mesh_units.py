"""One rule for lengths: the file's unit, then the caller's scale, each applied once everywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from support.mesh_files import binary_stl, prism_triangles, zipped

from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.scenarios import Scenario

URDF = """<robot name="r"><link name="base"><collision><geometry>
<mesh filename="{file}" scale="2 2 2"/></geometry></collision></link></robot>"""
SCENE = """\
version: 1
name: scene
workspace: {{low: [-50, -50], high: [50, 50]}}
shapes:
  part: {{kind: mesh, file: {file}, scale: 2.0}}
  disc: {{kind: disc, radius: 0.3}}
models:
  part: {{shape: part, drive: {{kind: differential, speed: 1.0, turn_rate: 2.0}}}}
robots:
- {{name: a, model: part, start: [-20, 0, 0], goal: [20, 0, 0]}}
"""


def millimeter_3mf() -> bytes:
    """The prism in millimeters: 2000 mm long."""
    vertices, faces = prism_triangles()
    points = "".join(f'<vertex x="{x:g}" y="{y:g}" z="{z:g}"/>' for x, y, z in 1000 * vertices)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    name = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    model = (
        f'<model unit="millimeter" xmlns="{name}"><resources><object id="1"><mesh>'
        f"<vertices>{points}</vertices><triangles>{triangles}</triangles></mesh></object>"
        '</resources><build><item objectid="1"/></build></model>'
    )
    types = (
        '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default'
        ' Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"'
        '/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-'
        '3dmodel+xml"/></Types>'
    )
    relations = (
        '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
        '<Relationship Id="a" Target="/3D/3dmodel.model"'
        ' Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    )
    members = {"[Content_Types].xml": types, "_rels/.rels": relations, "3D/3dmodel.model": model}
    return zipped(*((name, text.encode()) for name, text in members.items()))


def millimeter_dae() -> bytes:
    """The prism in millimeters, z up."""
    vertices, faces = prism_triangles()
    content: Any = trimesh.Trimesh(1000 * vertices, faces, process=False).export(file_type="dae")
    text = bytes(content).decode()
    unit = '<unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis>'
    place = text.index("<asset>") + len("<asset>")
    end = text.index("</asset>")
    inner = "<created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified>"
    return (text[:place] + inner + unit + text[end:]).encode()


def meter_glb() -> bytes:
    content: Any = trimesh.Trimesh(*prism_triangles(), process=False).export(file_type="glb")
    return bytes(content)


FILES = {
    "part.stl": lambda: binary_stl(*prism_triangles()),
    "part.3mf": millimeter_3mf,
    "part.dae": millimeter_dae,
    "part.glb": meter_glb,
}


@pytest.mark.parametrize("name", FILES)
def test_one_rule_everywhere(name: str, tmp_path: Path) -> None:
    """2 m long by the file, 4 m with a scale of 2: as a shape, in a scenario and in a robot."""
    path = tmp_path / name
    path.write_bytes(FILES[name]())
    shape = Shape.load(path)
    assert shape.report.extents == pytest.approx((2, 2, 1))
    assert shape.report.volume == pytest.approx(3)
    unit = shape.report.file.unit if shape.report.file else None
    assert (unit is None) == (name == "part.stl")
    assert Shape.load(path, scale=2.0).report.extents == pytest.approx((4, 4, 2))

    (tmp_path / "robot.urdf").write_text(URDF.format(file=name))
    robot = Robot.load(tmp_path / "robot.urdf")
    (part,) = robot.links[0].shapes
    assert np.ptp(part.shape.bounds, axis=0) == pytest.approx([4, 4, 2])

    (tmp_path / "scene.yaml").write_text(SCENE.format(file=name))
    (scene_part,) = Scenario.load(tmp_path / "scene.yaml").build().robots[0].parts
    assert np.ptp(scene_part.shape.bounds, axis=0) == pytest.approx([4, 4, 2])
