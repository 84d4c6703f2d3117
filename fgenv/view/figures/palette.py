"""Colors that stay distinct for people with color blindness (Okabe and Ito, 2008)."""

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Color: TypeAlias = tuple[float, float, float]  # sRGB, 0 to 1


def _hex(code: str) -> Color:
    red, green, blue = (int(code[i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue


BLACK = _hex("000000")
ORANGE = _hex("E69F00")
SKY = _hex("56B4E9")
GREEN = _hex("009E73")
YELLOW = _hex("F0E442")
BLUE = _hex("0072B2")
VERMILION = _hex("D55E00")
PURPLE = _hex("CC79A7")
INK = _hex("26303A")
STEEL = _hex("B9C0C7")
WHITE = _hex("FFFFFF")
MARKED: Color = (0.55, 0.77, 0.93)  # bodies in a robot's mask; a sky blue robot is darker
KINDS: dict[str, Color] = {"tree": (0.45, 0.60, 0.45), "shelf": (0.47, 0.54, 0.62)}
TEAM: tuple[Color, ...] = (ORANGE, BLUE, VERMILION, GREEN, PURPLE, SKY, YELLOW)


def robot_color(i: int) -> Color:
    """Return the color of robot i."""
    return TEAM[i % len(TEAM)]


def static_color(name: str) -> Color:
    """Return the color of a static body by the name of its shape."""
    return KINDS.get(name, STEEL)


def to_linear(srgb: ArrayLike) -> NDArray[np.float64]:
    """Convert sRGB values (0 to 1) to linear light, which can be added and multiplied."""
    c = np.asarray(srgb, dtype=np.float64)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def to_srgb(linear: ArrayLike) -> NDArray[np.float64]:
    """Convert linear light to sRGB values, clipped to 0 to 1."""
    c = np.clip(np.asarray(linear, dtype=np.float64), 0.0, 1.0)
    return np.where(c <= 0.0031308, c * 12.92, 1.055 * c ** (1 / 2.4) - 0.055)


def rgba(color: Color, opacity: float = 1.0) -> tuple[int, int, int, int]:
    """Return an sRGB color and an opacity (0 to 1) as bytes."""
    red, green, blue, alpha = (round(255 * c) for c in (*color, opacity))
    return red, green, blue, alpha
