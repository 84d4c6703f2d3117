"""Names that the command line completes and checks."""

from collections.abc import Iterable


def scenario_names(incomplete: str) -> list[str]:
    """Return the built-in scenarios that begin with a text."""
    from fgenv.scenarios.library import ENTRIES

    return [name for name in ENTRIES if name.startswith(incomplete)]


def policy_names(incomplete: str) -> list[str]:
    """Return the policies that begin with a text."""
    from fgenv.agents.policies.names import policy_names as registered

    return [name for name in registered() if name.startswith(incomplete)]


def methods() -> Iterable[str]:
    """Return the planning methods."""
    from fgenv.planners.methods import METHODS

    return METHODS


def planners() -> Iterable[str]:
    """Return the planners of OMPL that the method composite uses."""
    from fgenv.planners import PLANNERS

    return PLANNERS


def objectives() -> Iterable[str]:
    """Return the objectives of the optimizing planners."""
    from fgenv.planners.ompl.objectives import OBJECTIVES

    return OBJECTIVES


def cameras() -> Iterable[str]:
    """Return the cameras of movies and pictures."""
    from fgenv.view.figures.camera_path import CAMERAS

    return CAMERAS


def plot_kinds() -> Iterable[str]:
    """Return the kinds of plots."""
    from fgenv.view.figures.record_plots import KINDS

    return (*KINDS, "learning")


def methods_of_shapes() -> Iterable[str]:
    """Return the methods of feature graphs."""
    from fgenv.collision.feature_graph import METHODS

    return METHODS


def export_formats() -> Iterable[str]:
    """Return the formats of `fgenv export`."""
    return ("glb", "obj", "stl", "urdf", "yaml")
