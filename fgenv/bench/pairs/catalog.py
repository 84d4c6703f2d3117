"""The mesh pairs of ``fgenv bench pairs``, with 100 to 100,000 triangles."""

from __future__ import annotations

from dataclasses import dataclass

from fgenv.bench.common.meshes import Mesh, is_installed, load
from fgenv.bench.common.selection import select

ROBOTS, BULLET, GYM, TOOLBOX = "example-robot-data", "pybullet", "gymnasium-robotics", "rtb-data"
ADROIT = "adroit_hand/resources/meshes"


@dataclass(frozen=True)
class Source:
    """The origin of a mesh: package, path in its mesh folder, meters per file unit."""

    package: str
    path: str
    scale: float = 1.0

    def load(self) -> Mesh:
        """Return the mesh, in meters."""
        return load(self.package, self.path, self.scale)


@dataclass(frozen=True)
class Pair:
    """Two meshes; `b` moves."""

    name: str
    a: Source
    b: Source
    quick: bool = False  # part of --pairs quick

    @property
    def available(self) -> bool:
        """Whether both packages are installed (pybullet has no wheel for newer Pythons)."""
        return is_installed(self.a.package) and is_installed(self.b.package)


PAIRS = (
    Pair(
        "pr2 head, elbow",
        Source(ROBOTS, "pr2_description/meshes/head_v0/head_tilt_L.stl"),
        Source(ROBOTS, "pr2_description/meshes/upper_arm_v0/elbow_flex.stl"),
    ),
    Pair(
        "panda link5, hand",
        Source(ROBOTS, "panda_description/meshes/collision/link5.stl"),
        Source(ROBOTS, "panda_description/meshes/collision/hand.stl"),
        quick=True,
    ),
    Pair(
        "kettle, panda hand",
        Source(GYM, "kitchen_franka/kitchen_assets/meshes/kettle.stl"),
        Source(ROBOTS, "panda_description/meshes/collision/hand.stl"),
    ),
    Pair(
        "ur5 base, upper arm",
        Source(ROBOTS, "ur_description/meshes/ur5/collision/base.stl"),
        Source(ROBOTS, "ur_description/meshes/ur5/collision/upperarm.stl"),
    ),
    Pair(
        "solo legs",
        Source(ROBOTS, "solo_description/meshes/stl/with_foot/solo_upper_leg_left_side.stl"),
        Source(ROBOTS, "solo_description/meshes/stl/solo12/solo12_lower_leg_right_side.stl"),
        quick=True,
    ),
    Pair(
        "allegro palm, finger",
        Source(ROBOTS, "allegro_hand_description/meshes/base_link_left.STL"),
        Source(ROBOTS, "allegro_hand_description/meshes/link_12.0_left.STL"),
    ),
    Pair(
        "shelf, panda hand",
        Source(BULLET, "kiva_shelf/meshes/pod_lowres.stl"),
        Source(GYM, "kitchen_franka/franka_assets/meshes/visual/hand.stl"),
    ),
    Pair(
        "panda link1, link3",
        Source(GYM, "kitchen_franka/franka_assets/meshes/visual/link1.stl"),
        Source(GYM, "kitchen_franka/franka_assets/meshes/visual/link3.stl"),
    ),
    Pair(
        "so101 base, z1 gripper",
        Source(ROBOTS, "so_arm_description/meshes/so101/base_motor_holder_so101_v1.stl"),
        Source(ROBOTS, "z1_description/meshes/collision/z1_GripperStator.STL"),
    ),
    Pair(
        "z1 link1, link2",
        Source(ROBOTS, "z1_description/meshes/collision/z1_Link01.STL"),
        Source(ROBOTS, "z1_description/meshes/collision/z1_Link02.STL"),
        quick=True,
    ),
    Pair(
        "adroit arm, forearm",
        Source(GYM, f"{ADROIT}/upper_arm_asmbl_shoulder.stl", 1e-3),
        Source(GYM, f"{ADROIT}/forearm_Cy_PlateAsmbly.stl", 1e-3),
    ),
    Pair(
        "orion5 link2, link3",
        Source(TOOLBOX, "meshes/RAWR/Orion5/link2.stl", 1e-3),
        Source(TOOLBOX, "meshes/RAWR/Orion5/link3.stl", 1e-3),
    ),
    Pair(
        "monastery, husky",
        Source(BULLET, "samurai_monastry.obj"),
        Source(BULLET, "husky/meshes/base_link.stl"),
    ),
)


def select_pairs(which: str) -> tuple[Pair, ...]:
    """Return the pairs with installed meshes for `all`, `quick` or part of a name.

    Raises:
        ValueError: no pair matches.
        ModuleNotFoundError: the meshes of all these pairs are missing.
    """
    if which in ("all", "quick"):
        pairs = tuple(pair for pair in PAIRS if which == "all" or pair.quick)
    else:
        pairs = select(PAIRS, [which.lower()], "pairs")
    available = tuple(pair for pair in pairs if pair.available)
    if not available:
        for source in (pairs[0].a, pairs[0].b):
            source.load()  # raises the error with the package to install
    return available
