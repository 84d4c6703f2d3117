"""Pictures, movies and plots of scenes and episodes, and views in a browser."""

from fgenv.view.figures.camera import Camera
from fgenv.view.figures.painter import Mark, Painter
from fgenv.view.figures.picture import Picture
from fgenv.view.figures.surfaces import Floor, Light, Solid

__all__ = ["Camera", "Floor", "Light", "Mark", "Painter", "Picture", "Solid"]


def __dir__() -> list[str]:
    return __all__
