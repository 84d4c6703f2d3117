"""Planning groups of an SRDF file: the joints that each has."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from fgenv.robots import Robot


class PlanningGroups:
    """The groups of an SRDF file.

    A group lists joints, links (with the joint above each), chains of links, and other groups.

    Raises:
        ValueError: not an SRDF file.
        FileNotFoundError: no such file.
    """

    def __init__(self, srdf: Path, robot: Robot) -> None:
        if not srdf.is_file():
            raise FileNotFoundError(f"srdf: {srdf} does not exist, expected an SRDF file")
        try:
            root = ElementTree.parse(srdf).getroot()
        except ElementTree.ParseError as error:
            raise ValueError(f"srdf: {srdf}: got {error}, expected XML") from None
        self.srdf, self.robot = srdf, robot
        self.groups = {element.get("name", ""): element for element in root.findall("group")}
        base = {element.get("name", "") for element in root.findall("virtual_joint")}
        self.known = {joint.name for joint in robot.joints} | base

    def joints(self, group: str, outer: tuple[str, ...] = ()) -> frozenset[str]:
        """Names of the joints of a group; `outer` are the groups that contain it.

        Raises:
            ValueError: an unknown joint, link, group or element.
        """
        if group in outer or group not in self.groups:
            what = "contains itself" if group in outer else "does not exist"
            raise ValueError(f"srdf: {self.srdf}: group {group!r} {what}; correct the groups")
        joints: set[str] = set()
        for element in self.groups[group]:
            if not isinstance(element.tag, str):
                continue  # a comment
            name = element.get("name", "")
            if element.tag == "group":
                joints |= self.joints(name, (*outer, group))
            elif element.tag == "joint":
                joints |= self._checked(group, name)
            elif element.tag == "link":
                joints |= self._above(group, name)
            elif element.tag == "chain":
                ends = element.get("base_link", ""), element.get("tip_link", "")
                joints |= self._chain(group, *ends)
            elif element.tag != "passive_joint":  # has no motor: not planned for
                raise self._error(group, element.tag)
        return frozenset(joints)

    def _checked(self, group: str, joint: str) -> set[str]:
        if joint not in self.known:
            raise self._error(group, joint)
        return {joint}

    def _above(self, group: str, link: str) -> set[str]:
        if link == self.robot.root:
            return set()
        if link not in self.robot.parent_joints:
            raise self._error(group, link)
        return {self.robot.parent_joints[link].name}

    def _chain(self, group: str, base: str, tip: str) -> set[str]:
        """Joints from a link down to another."""
        joints, link = set(), tip
        while link != base:
            if link not in self.robot.parent_joints:
                raise self._error(group, f"chain from {base} to {tip}")
            joint = self.robot.parent_joints[link]
            joints.add(joint.name)
            link = joint.parent
        return joints

    def _error(self, group: str, name: str) -> ValueError:
        return ValueError(
            f"srdf: {self.srdf}: group {group!r}: got {name!r},"
            f" expected joints, links, chains and groups of {self.robot.name!r}"
        )
