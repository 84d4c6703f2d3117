"""Collision checkers that fgenv is raced against, each behind the same small interface."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from fgenv.bench.peers.base import Checker, Peer

# name -> (module here, module that must be installed)
KNOWN = {
    "fgenv": ("fgenv_", "fgenv"),
    "python-fcl": ("fcl_", "fcl"),
    "coal": ("coal_", "coal"),
    "trimesh": ("trimesh_", "fcl"),
    "mujoco": ("mujoco_", "mujoco"),
    "embree": ("embree_", "embreex"),
}


def installed() -> list[str]:
    """Names of the peers that can run here, fgenv first."""
    return [name for name, (_, needs) in KNOWN.items() if find_spec(needs) is not None]


def selected(names: str) -> list[str]:
    """The peers in `names`, comma-separated; all installed ones for an empty string."""
    return [name.strip() for name in names.split(",") if name.strip()] or installed()


def peer(name: str) -> Peer:
    """The peer called `name`; ValueError names what there is."""
    if name not in KNOWN:
        raise ValueError(f"peers names {name!r}, expected some of {', '.join(KNOWN)}")
    module, needs = KNOWN[name]
    if find_spec(needs) is None:
        raise ValueError(f'peer {name} is not installed: pip install "fgenv[bench]"')
    made: Peer = import_module(f"fgenv.bench.peers.{module}").PEER
    return made


__all__ = ["KNOWN", "Checker", "Peer", "installed", "peer", "selected"]
