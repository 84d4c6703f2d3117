"""Collision libraries behind one interface, a module per library."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from fgenv.bench.common.selection import split_names
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
    """Return the names of the installed peers, fgenv first."""
    return [name for name, (_, needs) in KNOWN.items() if find_spec(needs) is not None]


def selected(names: str) -> list[str]:
    """Return the peers in `names`, separated by commas; all installed ones for an empty string."""
    return list(split_names(names)) or installed()


def peer(name: str) -> Peer:
    """Return a peer by its name.

    Raises:
        ValueError: an unknown name, or the library is not installed.
    """
    if name not in KNOWN:
        raise ValueError(f"peers: got {name!r}, expected some of {', '.join(KNOWN)}")
    module, needs = KNOWN[name]
    if find_spec(needs) is None:
        raise ValueError(f'peers: {name} is not installed; remedy: pip install "fgenv[bench]"')
    made: Peer = import_module(f"fgenv.bench.peers.{module}").PEER
    return made


__all__ = ["KNOWN", "Checker", "Peer", "installed", "peer", "selected"]
