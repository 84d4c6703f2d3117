"""Registries: implementations by name, so that a lower layer never imports a higher one.

A value is an object, or a string "module:attribute" that is imported on first use.
"""

from __future__ import annotations

import importlib
from typing import Any

POLICIES: dict[str, Any] = {}  # factories (argument, seed) -> Policy, see `fgenv.envs.policy`
RENDERERS: dict[str, Any] = {}  # factories by render mode, see `fgenv.envs.rendering`


def load(target: Any) -> Any:
    """Return a registered object; import it if it is a string."""
    if not isinstance(target, str):
        return target
    module, _, attribute = target.partition(":")
    return getattr(importlib.import_module(module), attribute)
