"""Time limits hold in every phase, and nothing depends on the unit of length.

The simplifier's rope shortcut had a step of 1 m: a robot that went 400 m around a wall took 37 s
with a limit of 5 s, and a maze in inches took minutes. The work is counted here; no clock is read.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

import fgenv
from fgenv.planners import PlanningError, Problem, plan_composite
from fgenv.planners.deadline import Deadline
from fgenv.planners.multi.roadmap_set import RoadmapSet
from fgenv.scenarios import Scenario


def around_a_wall(k: float, **robot: Any) -> Scenario:
    """A cube that goes around a wall; all lengths are k times those of the scene in meters."""
    return Scenario.model_validate(
        {
            "version": 1,
            "name": "wall",
            "horizon": 100.0,
            "workspace": {"low": [-6 * k, -6 * k], "high": [6 * k, 6 * k]},
            "shapes": {
                "cube": {"kind": "box", "size": [k, k, k]},
                "wall": {"kind": "box", "size": [k, 9 * k, k]},
            },
            "models": {
                "m": {"shape": "cube", "drive": {"kind": "holonomic", "speed": k, "turn_rate": 1.0}}
            },
            "robots": [
                {"name": "r", "model": "m", "start": [-4 * k, 0, 0], "goal": [4 * k, 0, 0], **robot}
            ],
            "bodies": [{"name": "wall", "shape": "wall"}],
        }
    )


def test_the_work_does_not_depend_on_the_unit() -> None:
    facts = []
    for k in (1.0, 0.0254, 0.001, 1000.0):
        path = plan_composite(Problem.from_scenario(around_a_wall(k)), time_limit=1e6)
        facts.append(path.facts)
        length = sum(abs(b - a)[:2].max() for a, b in pairwise(path.paths[0]))
        assert 8 * k < length < 40 * k
    checked = [fact["motions_checked"] for fact in facts]
    assert max(checked) < 1.05 * min(checked)


@pytest.mark.parametrize("method", ["prioritized", "conflict_based"])
def test_the_construction_of_roadmaps_ends_at_the_time_limit(method: str) -> None:
    with pytest.raises(PlanningError, match=r"the time limit ended during .*; allow more time"):
        fgenv.plan("warehouse", n=16, method=method, time_limit=1e-6)


def test_a_roadmap_is_not_built_after_the_deadline() -> None:
    roadmaps = RoadmapSet(Problem.from_scenario("swap", n=2), Deadline.after(-1.0))
    with pytest.raises(PlanningError, match="the time limit ended"):
        roadmaps.check()


def test_no_shortcut_is_tried_after_the_deadline(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem.from_scenario(around_a_wall(1.0))
    alone = plan_composite(problem, simplify=False).facts["motions_checked"]
    monkeypatch.setattr(Deadline, "left", -1.0)
    late = plan_composite(problem).facts
    assert late["motions_checked"] <= alone + late["waypoints_found"]  # checked again at the end


@pytest.mark.parametrize("end", ["start", "goal"])
def test_an_end_outside_the_workspace_is_reported_at_once(end: str) -> None:
    inside = around_a_wall(1.0)
    outside = inside.robots[0].model_copy(update={end: (300.0, 0.0, 0.0)})
    with pytest.raises(PlanningError, match=f"{end} of 'r': is outside its workspace or its joint"):
        fgenv.plan(inside.replace(robots=[outside]), time_limit=1e6)
