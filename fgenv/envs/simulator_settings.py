"""Options of a simulator, checked at construction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .observations import Observation
from .rewards import Reward

MAX_WORLDS = 1_000_000
MAX_STEPS = 2**62 - 1


@dataclass(frozen=True)
class SimulatorSettings:
    """The options of `Simulator`, which documents them.

    Raises:
        ValueError, TypeError: with the option, its value and the expected value.
    """

    n_worlds: int
    observation: Observation
    reward: Reward
    actions: str
    way_point_seconds: float
    starts: str
    case_order: str
    clearance: bool
    tolerance: float
    autoreset: bool
    max_steps: int | None
    threads: int | None

    def __post_init__(self) -> None:
        check_type(self.observation, "observation", Observation)
        check_type(self.reward, "reward", Reward)
        check_choice(self.actions, "actions", ("drive", "way_points"))
        check_choice(self.starts, "starts", ("scenario", "random"))
        check_choice(self.case_order, "case_order", ("random", "seed"))
        check_integer(self.n_worlds, "worlds", MAX_WORLDS)
        if self.max_steps is not None:
            check_integer(self.max_steps, "max_steps", MAX_STEPS)
        check_number(self.way_point_seconds, "way_point_seconds", 1e-9, 1e3)
        check_number(self.tolerance, "tolerance", 1e-9, 0.1)
        if self.shortest_paths and self.actions == "way_points":
            raise ValueError(
                "path: got 'shortest' with actions='way_points', expected 'straight'; each way"
                " point is a path of its own"
            )

    @property
    def shortest_paths(self) -> bool:
        """Whether path hints follow shortest paths."""
        return self.observation.path_hint and self.observation.path == "shortest"


def check_choice(value: str, name: str, choices: tuple[str, ...]) -> None:
    """Raise ValueError if a value is none of the choices."""
    if value not in choices:
        raise ValueError(f"{name}: got {value!r}, expected {' or '.join(choices)}")


def check_type(value: Any, name: str, kind: type[Any]) -> None:
    """Raise TypeError if a value is of another type."""
    if not isinstance(value, kind):
        raise TypeError(f"{name}: got {value!r}, expected fgenv.envs.{kind.__name__}")


def check_integer(value: Any, name: str, most: int) -> None:
    """Raise ValueError if a value is no integer from 1 to `most`."""
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise ValueError(f"{name}: got {value!r}, expected an integer from 1 to {most}")


def check_number(value: Any, name: str, least: float, most: float) -> None:
    """Raise ValueError if a value is no number in a range."""
    if not isinstance(value, (int, float)) or not least <= value <= most:
        raise ValueError(f"{name}: got {value!r}, expected a number from {least:g} to {most:g}")
