"""SDF documents: one model, its elements known or refused, values parsed with file and line."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fgenv.collision.mesh_files.xml_tree import Element

from .documents import fail, read_document

EXPECTED = "an SDF file: <sdf>"
FLAGS = {"1": True, "true": True, "0": False, "false": False, "": False}
# Elements that are read, and elements that say nothing of kinematics and geometry.
READ = {
    "sdf": {"model", "world"},
    "model": {"static", "self_collide", "pose", "frame", "link", "joint"},
    "frame": {"pose"},
    "link": {"pose", "collision", "visual"},
    "joint": {"parent", "child", "axis", "axis2", "pose"},
    "axis": {"xyz", "limit", "mimic", "use_parent_model_frame"},
    "limit": {"lower", "upper", "velocity"},
    "mimic": {"multiplier", "offset", "reference"},
    "collision": {"pose", "geometry", "surface"},
    "visual": {"pose", "geometry"},
    "mesh": {"uri", "scale"},
}
READ["axis2"] = READ["axis"]
SKIPPED = {
    "model": {"plugin", "gripper", "allow_auto_disable", "enable_wind"},
    "link": {"inertial", "gravity", "enable_wind", "kinematic", "must_be_base_link"}
    | {"velocity_decay", "sensor", "projector", "audio_sink", "audio_source", "battery"}
    | {"light", "particle_emitter", "self_collide", "contact"},
    "joint": {"physics", "sensor", "gearbox_ratio", "gearbox_reference_body"}
    | {"thread_pitch", "screw_thread_pitch"},  # of kinds of joints that are refused
    "axis": {"dynamics", "initial_position"},
    "axis2": {"dynamics", "initial_position"},
    "limit": {"effort", "stiffness", "dissipation"},
    "collision": {"laser_retro", "max_contacts", "density", "auto_inertia_params"},
    "visual": {"material", "cast_shadows", "laser_retro", "transparency", "visibility_flags"}
    | {"meta", "plugin"},
    "mesh": {"convex_decomposition"},
}
NOTED = {"plugin", "gripper", "sensor", "contact"}  # of those that are skipped
REMEDIES = {
    "include": "paste the model that it includes",
    "model": "move its links and joints to the model around it",
    "submesh": "save it as a mesh file of its own",
}


@dataclass(frozen=True)
class SdfDocument:
    """The model of an SDF file.

    Attributes:
        path: the file.
        version: of the format, e.g. (1, 6).
        model: element.
        notes: receives sentences.
    """

    path: Path
    version: tuple[int, ...]
    model: Element
    notes: list[str]

    def check(self, element: Element) -> None:
        """Raise ValueError for a child that is neither read nor known to be irrelevant.

        Elements with the namespace of another program are left out, with a note.
        """
        read, skipped = READ[element.tag], SKIPPED.get(element.tag, set())
        for child in list(element.children):
            if child.namespace != self.model.namespace:
                element.children.remove(child)
                self.note(f"Elements of other programs are left out: {child.tag}.")
            elif child.tag in skipped:
                if child.tag in NOTED:
                    self.note(f"Elements that are left out: {child.tag}.")
            elif child.tag not in read:
                close = difflib.get_close_matches(child.tag, read, 1)
                remedy = f"; did you mean <{close[0]}>?" if close else ""
                remedy = f"; {REMEDIES[child.tag]}" if child.tag in REMEDIES else remedy
                known = ", ".join(sorted(read))
                fail(self.path, child, f"got it in <{element.tag}>", f"one of {known}{remedy}")

    def note(self, sentence: str) -> None:
        """Add a sentence to the notes, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)

    def named(self, element: Element) -> str:
        """The name of an element."""
        return element.get("name") or fail(self.path, element, "got no name", "name=")

    def text(self, element: Element, tag: str) -> str:
        """The text of a child that is required."""
        child = element.first(tag)
        text = "" if child is None else child.text.strip()
        return text or fail(self.path, element, f"got no {tag}", f"<{tag}>")

    def flag(self, element: Element, tag: str) -> bool:
        """The boolean in a child; False without it."""
        child = element.first(tag)
        return child is not None and self.boolean(child, child.text)

    def boolean(self, element: Element, text: str) -> bool:
        """A boolean of an element."""
        value = FLAGS.get(text.strip().lower())
        if value is None:
            fail(self.path, element, f"got {text[:20]!r}", "true or false")
        return value

    def number(self, element: Element, tag: str, default: float) -> float:
        """The number in a child; it may be infinite."""
        child = element.first(tag)
        return default if child is None else self.numbers(child, child.text, (1,), True)[0]

    def numbers(
        self, element: Element, text: str, counts: tuple[int, ...], infinite: bool = False
    ) -> list[float]:
        """Numbers separated by blanks.

        Args:
            counts: how many are valid.
            infinite: accept infinite ones.
        """
        try:
            values = [float(word) for word in text.split()]
        except ValueError:
            values = [math.nan]
        valid = all(math.isfinite(x) or (infinite and not math.isnan(x)) for x in values)
        if not valid or len(values) not in counts:
            expected = f"{' or '.join(map(str, counts))} numbers"
            fail(self.path, element, f"got {' '.join(text.split())[:40]!r}", expected)
        return values


def sdf_document(path: Path, notes: list[str]) -> SdfDocument:
    """The only model of a file, which may be alone in a world.

    Raises:
        FileNotFoundError: no such file.
        ValueError: not a regular file, malformed XML, or no single model.
    """
    root = read_document(path, EXPECTED)
    if root.tag != "sdf":
        raise ValueError(f"path: {path}: got <{root.tag}>, expected {EXPECTED}")
    try:
        version = tuple(int(word) for word in root.get("version").split("."))
    except ValueError:
        fail(path, root, f"version: got {root.get('version')[:20]!r}", "a version, e.g. 1.9")
    scopes = [root, *root.all("world")]
    models = [model for scope in scopes for model in scope.all("model")]
    includes = [include for scope in scopes for include in scope.all("include")]
    if len(models) != 1 or includes:
        count = f"got {len(models)} models and {len(includes)} includes"
        fail(path, root, count, "one model; save the robot's model in a file of its own")
    if root.all("world"):
        notes.append("The world around the model is left out.")
    document = SdfDocument(path, version, models[0], notes)
    document.check(models[0])
    return document


def unique(document: SdfDocument, elements: Mapping[str, Element], element: Element) -> str:
    """The name of an element, which no other has."""
    name = document.named(element)
    if name in elements:
        fail(document.path, element, "got two of this name", "unique names")
    return name
