"""A policy that drives a plan, and plans anew where the world is not as the plan took it."""

from __future__ import annotations

from fgenv.agents.planned import Planned


class Replanning(Planned):
    pass
