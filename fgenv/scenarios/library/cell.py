"""Arms around one table."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from fgenv.scenarios.registry import Seed, Size, builtin
from fgenv.scenarios.rng import Dice, micro, sin_cos
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.schema import Placement

from .placing import Q, bare, block, body, scatter, sent, team

ARM = "package://fgenv/scenarios/library/arm.urdf"
GAP = 0.002  # meters of a base plate that is not modeled: arms may stand on the table, not hit it
TURNED = (0.4, 1.3)  # of the first joint, rad: to the right at the start, to the left at the goal
PANDA = "package://fgenv/scenarios/library/mbm/panda"


@dataclass(frozen=True)
class Kind:
    """A kind of arm: its model, the angles of the joints after the first (rad), spacing (m)."""

    model: dict[str, Any]
    bent: tuple[tuple[float, float], ...]
    across: float


KINDS = {
    "light": Kind(
        {"urdf": ARM, "drive": {"kind": "joint_velocity"}},
        ((0.2, 1.1), (0.6, 1.7), (-1.5, 1.5), (0.2, 1.4), (-3.0, 3.0)),
        1.0,
    ),
    "panda": Kind(
        {
            "urdf": f"{PANDA}.urdf",
            "srdf": f"{PANDA}.srdf",
            "drive": {"kind": "joint_velocity", "acceleration": 7.5},
        },
        ((0.1, 0.7), (-0.3, 0.3), (-2.3, -1.5), (-0.4, 0.4), (1.7, 2.5), (0.4, 1.2)),
        1.1,
    ),
}


@builtin(dimension=3, most=12)
def cell(
    n: Annotated[int, Field(ge=1, le=12, strict=True)] = 2,
    seed: Seed = 0,
    size: Size = None,
    arm: Literal["light", "panda"] = "light",
) -> Scenario:
    """Arms around one table reach across each other: URDF, needs the extra urdf.

    Args:
        n: arms, up to 12.
        seed: of starts and goals.
        size: diameter of the circle of bases, meters; grows with n if left out. An arm reaches
            0.85 m.
        arm: `light`, of six joints, or `panda`, of seven with the meshes of mbm.
    """
    kind = KINDS[arm]
    across = size or micro(max(kind.across, 0.42 * n))
    top = micro(across + 0.4)
    mounts = [_mount(2 * math.pi * i / n, across / 2) for i in range(n)]
    scenario = bare(
        "cell",
        description=f"{n} arms around a table reach across each other.",
        seed=seed,
        horizon=30.0,
        shapes={
            "table": {"kind": "box", "size": (top, top, 0.06)},
            "crate": block(0.2, 0.16, 0.12),
        },
        models={"arm": kind.model},
        robots=[
            spec.model_copy(update={"mount": mount})
            for spec, mount in zip(
                team(n, "arm", 1 + len(kind.bent), goal_tolerance={"angle": 0.05}),
                mounts,
                strict=True,
            )
        ],
        bodies=[
            {"name": "table", "shape": "table", "position": (0.0, 0.0, -0.03)},
            body("crate", 0.0, 0.0, 0.3, name="crate").model_copy(
                update={"position": (0.0, 0.0, GAP)}
            ),
        ],
    )
    dice = Dice(seed, 8)

    def reach(side: int) -> Q:
        first = side * dice.between(*TURNED)
        return (first, *(dice.between(*ends) for ends in kind.bent))

    starts = scatter(scenario, lambda _: reach(-1))
    return sent(scenario, starts, scatter(scenario, lambda _: reach(1)))


def _mount(angle: float, radius: float) -> Placement:
    """The base of an arm, on the table, facing its middle."""
    y, x = sin_cos(angle)
    yaw = math.remainder(angle + math.pi, 2 * math.pi)
    at = micro(radius * x), micro(radius * y), GAP
    return Placement(position=at, rpy=(0.0, 0.0, micro(yaw)))
