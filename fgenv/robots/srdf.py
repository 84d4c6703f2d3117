"""Semantics of a robot from SRDF: allowed collisions, planning groups, named states."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .links_joints import Joint, Link, number_of
from .urdf_document import parsed_document

# Elements that change nothing in a Robot, with the reason.
WITHOUT_EFFECT = {
    "link_sphere_approximation": "exact shapes are used",
    "joint_property": "planners do not read it",
}


@dataclass(frozen=True)
class EndEffector:
    """A group of links that is mounted on a link."""

    parent_link: str
    group: str
    parent_group: str | None = None


@dataclass(frozen=True)
class VirtualJoint:
    """The joint between the world and the root, `fixed`, `planar` or `floating`."""

    kind: str
    parent_frame: str
    child_link: str


@dataclass(frozen=True)
class Semantics:
    """The content of an SRDF file.

    Attributes:
        allowed: pairs of links that may touch.
        groups: names of the joints of each planning group, in the order of the robot's; a virtual
            joint is first.
        states: values of joints (rad or m) by group and name of the state.
        end_effectors, virtual_joints: by name.
        passive: names of joints without a motor.
        faulty_groups: why each group that the robot does not have is left out.
        notes: sentences on what was left out.
    """

    allowed: tuple[tuple[str, str], ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    states: Mapping[tuple[str, str], Mapping[str, float]] = field(default_factory=dict)
    end_effectors: Mapping[str, EndEffector] = field(default_factory=dict)
    virtual_joints: Mapping[str, VirtualJoint] = field(default_factory=dict)
    passive: tuple[str, ...] = ()
    faulty_groups: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


BASES = {"floating": "free"}  # kinds of virtual joints that a Robot names otherwise
NO_SEMANTICS = Semantics()


def read_srdf(
    path: str | Path,
    name: str,
    links: Iterable[Link],
    joints: Iterable[Joint],
    base: str = "fixed",
) -> Semantics:
    """The semantics of a robot of some links and joints, and a kind of base.

    Raises:
        FileNotFoundError: no such file.
        ValueError: no SRDF file, or an element without an attribute that it needs.
    """
    return _Reader(Path(path), [link.name for link in links], list(joints)).read(name, base)


class _Reader:
    """Reader of one file."""

    def __init__(self, path: Path, links: list[str], joints: list[Joint]) -> None:
        self.path, self.links, self.joints = path, links, joints
        self.parent_joints = {joint.child: joint for joint in joints}
        self.notes: list[str] = []
        self.root = parsed_document(path, self.notes, "an SRDF file")
        self.virtual = {
            self._get(e, "name"): VirtualJoint(
                self._get(e, "type"), self._get(e, "parent_frame"), self._get(e, "child_link")
            )
            for e in self.root.findall("virtual_joint")
        }
        self.elements = {self._get(e, "name"): e for e in self.root.findall("group")}

    def read(self, name: str, base: str) -> Semantics:
        """Return the content of the file for a robot of this name and base."""
        if self.root.get("name") != name:
            self.notes.append(f"The SRDF is of robot {self.root.get('name')!r}, not {name!r}.")
        for joint, virtual in self.virtual.items():
            if (kind := BASES.get(virtual.kind, virtual.kind)) != base:
                self.notes.append(
                    f"The virtual joint {joint!r} is {virtual.kind}, the base is {base}; give"
                    f" base={kind!r} if it moves."
                )
        groups, faults = self._groups()
        states = self._states(groups)
        allowed = tuple(self._allowed())
        passive = tuple(self._get(e, "name") for e in self.root.iter("passive_joint"))
        if passive:
            self.notes.append(f"Passive joints move like others: {', '.join(passive)}.")
        effectors = {
            self._get(e, "name"): EndEffector(
                self._get(e, "parent_link"), self._get(e, "group"), e.get("parent_group")
            )
            for e in self.root.findall("end_effector")
        }
        self._note_rest()
        return Semantics(
            allowed, groups, states, effectors, self.virtual, passive, faults, tuple(self.notes)
        )

    # Collisions

    def _allowed(self) -> list[tuple[str, str]]:
        """Pairs of links that may touch, as MoveIt's allowed collision matrix has them.

        A link without default collisions may touch every link; then pairs are enabled, and last
        disabled.
        """
        pairs: set[frozenset[str]] = set()
        for element in self.root.findall("disable_default_collisions"):
            for link in self._known([self._get(element, "link")]):
                pairs |= {frozenset((link, other)) for other in self.links if other != link}
                self.notes.append(
                    f"Default collisions of link {link!r} are disabled with the robot's links;"
                    " with other bodies they are checked."
                )
        pairs -= set(self._pairs("enable_collisions"))
        pairs |= set(self._pairs("disable_collisions"))
        rank = {name: i for i, name in enumerate(self.links)}
        ordered = (sorted(pair, key=rank.__getitem__) for pair in pairs if len(pair) == 2)
        return sorted((a, b) for a, b in ordered)

    def _pairs(self, tag: str) -> list[frozenset[str]]:
        rows = [[self._get(e, "link1"), self._get(e, "link2")] for e in self.root.findall(tag)]
        known = set(self._known(itertools.chain.from_iterable(rows)))
        return [frozenset(row) for row in rows if known.issuperset(row)]

    def _known(self, links: Iterable[str]) -> list[str]:
        """The links that the robot has; others are noted, once each."""
        names = dict.fromkeys(links)
        for name in names:
            note = f"Link {name!r} of the SRDF is not in the robot; its pairs are left out."
            if name not in self.links and note not in self.notes:
                self.notes.append(note)
        return [name for name in names if name in self.links]

    # Groups

    def _groups(self) -> tuple[dict[str, tuple[str, ...]], dict[str, str]]:
        """Joints of each group, and why a group is left out."""
        order = [*self.virtual, *(joint.name for joint in self.joints)]
        groups: dict[str, tuple[str, ...]] = {}
        faults: dict[str, str] = {}
        for name in self.elements:
            try:
                inside = self._joints_of(name, ())
            except LookupError as error:
                faults[name] = str(error.args[0])
                self.notes.append(f"The group {name!r} is left out: {faults[name]}.")
                continue
            groups[name] = tuple(joint for joint in order if joint in inside)
        return groups, faults

    def _joints_of(self, group: str, outer: tuple[str, ...]) -> set[str]:
        """Names of the joints of a group; `outer` are the groups that contain it.

        Raises:
            LookupError: an unknown joint, link, group or element.
        """
        if group in outer or group not in self.elements:
            what = "contains itself" if group in outer else "does not exist"
            raise LookupError(f"the group {group!r} {what}")
        joints: set[str] = set()
        for element in self.elements[group]:
            if element.tag == "group":
                joints |= self._joints_of(self._get(element, "name"), (*outer, group))
            elif element.tag == "joint":
                joints.add(self._joint(self._get(element, "name")))
            elif element.tag == "link":
                joints |= self._above(self._get(element, "name"))
            elif element.tag == "chain":
                ends = self._get(element, "base_link"), self._get(element, "tip_link")
                joints |= self._chain(*ends)
            elif element.tag != "passive_joint":
                raise LookupError(f"got <{element.tag}>, expected joint, link, chain or group")
        return joints

    def _joint(self, name: str) -> str:
        if name not in self.virtual and all(name != joint.name for joint in self.joints):
            raise LookupError(f"got joint {name!r}, expected one of the robot")
        return name

    def _above(self, link: str) -> set[str]:
        """The joint above a link; none above the root."""
        if link not in self.links:
            raise LookupError(f"got link {link!r}, expected one of the robot")
        joint = self.parent_joints.get(link)
        return set() if joint is None else {joint.name}

    def _chain(self, base: str, tip: str) -> set[str]:
        """Joints from a link down to another."""
        joints, link = set(), tip
        while link != base:
            if link not in self.parent_joints:
                raise LookupError(
                    f"got a chain from {base!r} to {tip!r}, expected a path of joints"
                )
            joints.add(self.parent_joints[link].name)
            link = self.parent_joints[link].parent
        return joints

    # States

    def _states(
        self, groups: Mapping[str, tuple[str, ...]]
    ) -> dict[tuple[str, str], Mapping[str, float]]:
        """Values of joints by group and name."""
        states: dict[tuple[str, str], Mapping[str, float]] = {}
        for element in self.root.findall("group_state"):
            key = self._get(element, "group"), self._get(element, "name")
            if key[0] not in groups:
                self.notes.append(f"The state {key[1]!r} is left out: it is of group {key[0]!r}.")
                continue
            values, others = self._values(element, groups[key[0]])
            if others:
                self.notes.append(
                    f"The state {key[1]!r} of group {key[0]!r} is without the joints that have no"
                    f" value in the group: {', '.join(others)}."
                )
            states[key] = values
        return states

    def _values(self, state: Any, group: Iterable[str]) -> tuple[dict[str, float], list[str]]:
        """Values of the joints of a state, and names of joints that have none.

        These are joints outside the group, and virtual joints: the base is placed elsewhere.
        """
        values, others = {}, []
        for element in state.findall("joint"):
            name, text = self._get(element, "name"), self._get(element, "value")
            if name not in group or name in self.virtual:
                others.append(name)
                continue
            try:
                values[name] = number_of(float(text), "value", finite=True)
            except ValueError:
                raise ValueError(
                    f"{self.path}: line {element.sourceline}: joint {name!r}: value: got {text!r},"
                    " expected a number"
                ) from None
        return values, others

    # The rest

    def _note_rest(self) -> None:
        """Note elements without effect, and those that SRDF does not define."""
        known = {"virtual_joint", "group", "group_state", "end_effector", "passive_joint"}
        known |= {"disable_collisions", "enable_collisions", "disable_default_collisions"}
        for tag in dict.fromkeys(element.tag for element in self.root):
            if tag in WITHOUT_EFFECT:
                self.notes.append(f"<{tag}> has no effect: {WITHOUT_EFFECT[tag]}.")
            elif tag not in known:
                self.notes.append(f"<{tag}> is no element of SRDF; it is left out.")

    def _get(self, element: Any, attribute: str) -> str:
        value = element.get(attribute)
        if not value:
            raise ValueError(
                f"{self.path}: line {element.sourceline}: <{element.tag}>: got no {attribute},"
                f" expected {attribute}="
            )
        return str(value)
