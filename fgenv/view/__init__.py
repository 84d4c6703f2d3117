"""Pictures of scenes, drawn by a small ray caster: no OpenGL and no display needed."""

from fgenv.view.camera import Camera
from fgenv.view.frame import Mark, Painter
from fgenv.view.picture import Picture
from fgenv.view.shader import render
from fgenv.view.surfaces import Floor, Light, Solid

__all__ = ["Camera", "Floor", "Light", "Mark", "Painter", "Picture", "Solid", "render"]
