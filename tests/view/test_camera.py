"""The camera: projection, axes, invalid cameras."""

from __future__ import annotations

import numpy as np
import pytest

from fgenv.view import Camera

FRONT = Camera(eye=(0.0, -4.0, 0.0), target=(0.0, 0.0, 0.0), fov=0.6, width=200, height=160)


@pytest.mark.parametrize("seed", range(5))
def test_projection_inverts_rays(seed: int) -> None:
    rng = np.random.default_rng(seed)
    camera = Camera(tuple(rng.normal(size=3)), tuple(rng.normal(size=3)), rng.uniform(0.2, 2.0))
    pixels = rng.uniform((0, 0), (camera.width, camera.height), size=(100, 2))
    points = camera.eye + camera.rays(pixels) * rng.uniform(1, 9, size=(100, 1))
    back, depth = camera.project(points)
    np.testing.assert_allclose(back, pixels, atol=1e-8)
    assert (depth > 0).all()


def test_axes_are_a_right_handed_frame_with_up_on_top() -> None:
    right, down, ahead = Camera((1.0, 2.0, 3.0), (4.0, 4.0, 0.0)).axes
    np.testing.assert_allclose(np.cross(right, down), ahead, atol=1e-12)
    assert down[2] < 0
    assert right[2] == pytest.approx(0.0, abs=1e-12)
    pixels, _ = FRONT.project([(0, 0, 0), (0.5, 0, 0), (0, 0, 0.5)])
    np.testing.assert_allclose(pixels[0], (100, 80))
    assert pixels[1, 0] > 100  # x to the right, seen from -y
    assert pixels[2, 1] < 80  # z up


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"target": (0.0, -4.0, 9.0)}, "straight above"),
        ({"fov": 0.0}, "fov"),
        ({"width": 0}, "width"),
        ({"eye": (0.0, np.nan, 0.0)}, "eye"),
    ],
)
def test_invalid_cameras_are_errors(change: dict[str, object], message: str) -> None:
    good: dict[str, object] = {"eye": (0.0, -4.0, 0.0), "target": (0.0, 0.0, 0.0)}
    with pytest.raises(ValueError, match=message):
        Camera(**{**good, **change})  # type: ignore[arg-type]
