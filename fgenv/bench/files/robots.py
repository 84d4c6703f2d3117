"""All URDF files in pip packages: forward kinematics and geometry against pinocchio."""

from __future__ import annotations

import itertools
import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.bench.common.records import Record
from fgenv.robots import Joint, Robot

from .meshes import files_with

SAMPLES = 5  # configurations of each robot
TOLERANCE = 1e-9  # meters, and of rotation matrices
MESH_TOLERANCE = 1e-5  # of the size of a mesh, which pinocchio reads in single precision

AGREES, REFUSED = "agrees", "refused: "
# Reasons for which files are refused, and what each error says.
REASONS = {
    "a mesh file is missing": "got no such file",
    "a wrong number of numbers": "expected .*numbers$",
    "a limit is no number": "limit: .* expected a number",
    "no XML": "expected XML$",
    "no link": "got no <link>",
    "a geometry that URDF does not define": "collision geometry: got",
    "a joint that URDF does not define": "type: got",
    "a mimic joint follows no joint": "no such joint",
    "a lower limit over the upper one": "got lower .* over upper",
    "a mesh with a vertex of NaN": "coordinate nan",
}


def bench_robots(quick: bool, progress: Any) -> Iterator[Record]:
    """Yield a row for each result: agreement, or a reason of refusal."""
    files = files_with({".urdf"})
    files = files[:: max(1, len(files) // 60)] if quick else files
    yield from results_of(files, compare_robot, REASONS, progress)


def results_of(
    files: Sequence[tuple[str, Path]],
    compare: Callable[[Path], tuple[str, float]],
    reasons: Mapping[str, str],
    progress: Any,
) -> Iterator[Record]:
    """Yield a row for each result of the comparison of files."""
    results: dict[str, list[tuple[str, float]]] = {}
    for k, (label, path) in enumerate(files):
        progress(f"{k} of {len(files)} robots: {label}")
        result, difference = compare(path)
        results.setdefault(result, []).append((label, difference))
    for result, rows in sorted(results.items(), key=lambda item: -len(item[1])):
        labels = [label for label, _ in rows]
        refused = result.startswith(REFUSED)
        explained = result == AGREES or result.removeprefix(REFUSED) in reasons
        yield {
            "result": result,
            "files": len(rows),
            "difference": None if refused else max(difference for _, difference in rows),
            "refused": labels if refused else [],
            "unexplained": [] if explained else labels,
        }


def compare_robot(path: Path) -> tuple[str, float]:
    """Load one file and compare poses of links and boxes of meshes with pinocchio.

    Returns:
        AGREES, what differs, or the reason of refusal; the largest difference of poses.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            robot = Robot.load(path, package_dirs=package_folders(path))
    except (ValueError, OSError) as error:
        return REFUSED + reason_of(str(error), REASONS), math.nan
    peer = Pinocchio(path, robot)
    rng = np.random.default_rng(0)
    low, high = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    configurations = rng.uniform(low, np.maximum(low, high), (SAMPLES, robot.nq))
    difference = max(
        float(np.abs(robot.forward(q) - peer.forward(q)).max()) for q in configurations
    )
    if difference > TOLERANCE:
        return "poses differ", difference
    boxes = peer.boxes()
    differing = boxes is not None and not same_boxes(own_boxes(robot), boxes)
    return "shapes differ" if differing else AGREES, difference


def reason_of(message: str, reasons: Mapping[str, str]) -> str:
    """The reason that an error has, or the error itself."""
    found = (reason for reason, pattern in reasons.items() if re.search(pattern, message))
    return next(found, message)


def package_folders(path: Path) -> list[Path]:
    """Folders of packages above a file."""
    return list(itertools.islice(path.parents, 4))


class Pinocchio:
    """The robot of the same file in pinocchio, which gives each mimic joint a coordinate."""

    def __init__(self, path: Path, robot: Robot) -> None:
        import pinocchio

        self.pin, self.path, self.robot = pinocchio, path, robot
        self.model = pinocchio.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        body = pinocchio.FrameType.BODY
        self.frames = [self.model.getFrameId(link.name, body) for link in robot.links]

    def forward(self, q: Floats) -> Floats:
        """Poses of the links, (links, 4, 4)."""
        x = self.pin.neutral(self.model)
        values = dict(zip(self.robot.coordinates, q.tolist(), strict=True))
        joints = {joint.name: joint for joint in self.robot.joints}
        for joint in filter(lambda j: j.moves, self.robot.joints):
            index = self.model.joints[self.model.getJointId(joint.name)]
            angle = value_of(joint, joints, values)
            part = (angle,) if index.nq == 1 else (math.cos(angle), math.sin(angle))
            x[index.idx_q : index.idx_q + index.nq] = part
        self.pin.framesForwardKinematics(self.model, self.data, x)
        return np.array([self.data.oMf[frame].homogeneous for frame in self.frames])

    def boxes(self) -> dict[str, list[Floats]] | None:
        """Bounding boxes of mesh shapes in the frames of their links; None: it reads no meshes."""
        folders = [str(folder) for folder in package_folders(self.path)]
        files = str(self.path), self.pin.GeometryType.COLLISION
        try:
            shapes = self.pin.buildGeomFromUrdf(self.model, *files, package_dirs=folders)
        except (ValueError, RuntimeError):  # it looks for meshes elsewhere
            return None
        boxes: dict[str, list[Floats]] = {}
        for shape in shapes.geometryObjects:
            if not hasattr(shape.geometry, "vertices"):
                continue  # a primitive
            frame = self.model.frames[shape.parentFrame]
            pose = (frame.placement.inverse() * shape.placement).homogeneous
            points = shape.geometry.vertices() @ pose[:3, :3].T + pose[:3, 3]
            boxes.setdefault(frame.name, []).append(box_of(points))
        return boxes


def value_of(joint: Joint, joints: Mapping[str, Joint], values: Mapping[str, float]) -> float:
    """The coordinate of a joint, which may mimic another."""
    m = joint.mimic
    if m is None:
        return values[joint.name]
    return m.multiplier * value_of(joints[m.joint], joints, values) + m.offset


def own_boxes(robot: Robot) -> dict[str, list[Floats]]:
    """Bounding boxes of a robot's shapes in the frames of their links."""
    return {
        link.name: [
            box_of(item.shape.vertices @ item.origin[:3, :3].T + item.origin[:3, 3])
            for item in link.shapes
        ]
        for link in robot.links
    }


def box_of(points: Floats) -> Floats:
    """Least and greatest coordinates, (2, 3)."""
    return np.array([points.min(axis=0), points.max(axis=0)])


def same_boxes(own: Mapping[str, list[Floats]], expected: Mapping[str, list[Floats]]) -> bool:
    """Whether each expected box of a link is one of the link's own."""
    for link, boxes in expected.items():
        for box in boxes:
            near = MESH_TOLERANCE * max(1e-3, float(np.ptp(box, axis=0).max()))
            if all(float(np.abs(box - other).max()) > near for other in own.get(link, ())):
                return False
    return True
