"""Trained policies included in the package: `mlp:NAME` is NAME.npz in this folder."""

from pathlib import Path


def included() -> dict[str, Path]:
    """Return the included policy files by name."""
    return {path.stem: path for path in sorted(Path(__file__).parent.glob("*.npz"))}
