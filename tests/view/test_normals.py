"""Shading normals and sRGB colors."""

import numpy as np
import trimesh

from fgenv.view.figures.normals import corner_normals, normal_maps
from fgenv.view.figures.palette import to_linear, to_srgb


def test_normals_of_a_box_are_its_sides_and_of_a_ball_its_radii() -> None:
    box = trimesh.creation.box((1, 2, 3))
    sharp = corner_normals(box.vertices, box.faces, 0.6)
    np.testing.assert_allclose(sharp, np.repeat(box.face_normals[:, None], 3, axis=1), atol=1e-12)
    mesh = trimesh.creation.icosphere(subdivisions=3)
    smooth = corner_normals(mesh.vertices, mesh.faces, 0.6)
    assert np.einsum("mki,mki->mk", smooth, mesh.vertices[mesh.faces]).min() > 0.999


def test_normal_maps_meet_the_corner_normals_at_the_corners() -> None:
    mesh = trimesh.creation.torus(1.0, 0.3)
    corners = mesh.vertices[mesh.faces]
    maps = normal_maps(mesh.vertices, mesh.faces, 0.6)
    at_corners = np.einsum("mij,mkj->mki", maps[:, :, :3], corners) + maps[:, None, :, 3]
    truth = corner_normals(mesh.vertices, mesh.faces, 0.6)
    np.testing.assert_allclose(at_corners, truth, atol=1e-9)


def test_srgb_there_and_back() -> None:
    values = np.linspace(0, 1, 101)
    np.testing.assert_allclose(to_srgb(to_linear(values)), values, atol=1e-6)
