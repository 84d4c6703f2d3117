"""Disabled collisions of links, from SRDF."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from .documents import read_document
from .links_joints import Link


def disabled_collisions(srdf: str | Path, links: Iterable[Link]) -> list[tuple[str, str]]:
    """Pairs of links with collisions disabled by an SRDF file; unknown links are skipped."""
    path = Path(srdf)
    root = read_document(path, "an SRDF file")
    if root.tag != "robot":
        raise ValueError(f"srdf: {path}: got <{root.tag}>, expected an SRDF file: <robot>")
    known = {link.name for link in links}
    pairs = [
        (e.get("link1", ""), e.get("link2", ""))
        for e in root.below()
        if e.tag == "disable_collisions"
    ]
    return [pair for pair in pairs if known.issuperset(pair)]
