"""Tab completion of names on the command line."""


def scenario_names(incomplete: str) -> list[str]:
    """Return the built-in scenarios that begin with a text."""
    from fgenv.scenarios.library import ENTRIES

    return [name for name in ENTRIES if name.startswith(incomplete)]


def policy_names(incomplete: str) -> list[str]:
    """Return the policies that begin with a text."""
    from fgenv.agents.policies.names import policy_names as registered

    return [name for name in registered() if name.startswith(incomplete)]


def method_names(incomplete: str) -> list[str]:
    """Return the planning methods that begin with a text."""
    from fgenv.planners.methods import METHODS

    return [name for name in METHODS if name.startswith(incomplete)]


def plot_kinds(incomplete: str) -> list[str]:
    """Return the kinds of plots that begin with a text."""
    kinds = ("clearance", "masks", "space-time", "learning")
    return [kind for kind in kinds if kind.startswith(incomplete)]
