"""What happens during a journey, told as it happens: `report(event)` gets one of these."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from fgenv.arrays import Floats
from fgenv.collision import Contact
from fgenv.planners import PlanarPlan, Proof

Configuration = tuple[float, float, float]


@dataclass(frozen=True)
class MasksSet:
    """A path was projected: the motion box of each leg, (n - 1, 2, 3), and all masks by name."""

    time: float
    path: Floats
    motion_boxes: Floats
    masks: dict[str, int]


@dataclass(frozen=True)
class Hit:
    """A first contact: when (s), of which pair, free just before and colliding just after.

    `before` and `after` are configurations no point of the mover goes more than `bracket` meters
    between; `seen` is the time of the step that noticed; `contact` tells feature edge and face.
    """

    time: float
    seen: float
    mover: str
    body: str
    before: Configuration
    after: Configuration
    bracket: float
    contact: Contact


@dataclass(frozen=True)
class MasksCleared:
    """The motion is over, the mover's bit is taken back."""

    time: float
    masks: dict[str, int]


@dataclass(frozen=True)
class Replanned:
    """A new path (n, 3) to the goal: `back_off` meters back the way it came, then the plan.

    `proof` is that that the plan is free; the way back has been driven before.
    """

    time: float
    path: Floats
    back_off: float
    plan: PlanarPlan
    proof: Proof


@dataclass(frozen=True)
class Arrived:
    """The mover stands at the end of its path."""

    time: float
    configuration: Configuration


Event: TypeAlias = MasksSet | Hit | MasksCleared | Replanned | Arrived
Report: TypeAlias = Callable[[Event], None]


def silent(event: Event) -> None:
    """A report that says nothing."""
