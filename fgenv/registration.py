"""Registration of policies, renderers and environment ids by string; nothing heavy is imported."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from fgenv.registry import POLICIES, RENDERERS


def register() -> None:
    """Register all of fgenv's implementations."""
    POLICIES.update(
        goto="fgenv.agents.policies.goto:goto",
        orca="fgenv.agents.policies.orca:orca",
        random="fgenv.agents.policies.random:random",
        rest="fgenv.agents.policies.rest:rest",
        plan="fgenv.agents.policies.plan:plan",
        replan="fgenv.agents.policies.replan:replan",
        mlp="fgenv.agents.policies.network:mlp",
        sb3="fgenv.agents.policies.sb3:sb3",
        safe="fgenv.agents.policies.safety_filter:safe",
    )
    RENDERERS.update(
        rgb_array="fgenv.view.figures.scenario_painter:ScenarioPainter",
        human="fgenv.view.web.live:Live",
    )
    after_import("gymnasium", register_gymnasium)
    after_import("pettingzoo", register_pettingzoo)


def register_gymnasium() -> None:
    """Register each built-in scenario with drives as `fgenv/NAME-v0`: one robot learns."""
    import gymnasium

    for name in driven_scenarios():
        gymnasium.register(
            f"fgenv/{name}-v0",
            "fgenv.envs.single:FleetEnv",
            vector_entry_point="fgenv.envs.vector:FleetVectorEnv",
            kwargs={"scenario": name},
        )


def register_pettingzoo() -> None:
    """Register each built-in scenario with drives as `fgenv/NAME-v0`, parallel and AEC."""
    import pettingzoo

    if not hasattr(pettingzoo, "register"):  # before PettingZoo 1.27
        return
    for name in driven_scenarios():
        given = {"scenario": name}
        parallel = "fgenv.envs.parallel:parallel_env"
        pettingzoo.register("parallel", f"fgenv/{name}-v0", parallel, kwargs=given)
        pettingzoo.register("aec", f"fgenv/{name}-v0", "fgenv.envs.aec:env", kwargs=given)


def driven_scenarios() -> list[str]:
    """Names of the built-in scenarios whose robots have drives."""
    from fgenv.scenarios.library import ENTRIES

    return [name for name, entry in ENTRIES.items() if entry.driven]


def after_import(package: str, function: Callable[[], None]) -> None:
    """Call a function once a package has been imported: now, or later.

    Gymnasium takes several times as long to import as fgenv, so that registration waits for it.
    """
    if package in sys.modules:
        function()
    else:
        sys.meta_path.insert(0, _AfterImport(package, function))


class _AfterImport(MetaPathFinder):
    """Runs a function after the first import of a package."""

    def __init__(self, package: str, function: Callable[[], None]) -> None:
        self._package, self._function = package, function

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Find the package as usual, and extend its loader."""
        if name != self._package:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.loader is not None:
            execute, function = spec.loader.exec_module, self._function

            def exec_module(module: ModuleType) -> None:
                execute(module)
                function()

            spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec
