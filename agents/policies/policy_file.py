"""Files of trained policies: a network with its settings, usable without PyTorch.

An archive (`fgenv.archive`) of the format "fgenv policy 1":

    about       JSON: name, command, seed, scenario (name and overrides of the training),
                steps; observation (arguments of `fgenv.envs.Observation`), parts (name and size of
                each part of an observation, in order), actions (drive or way_points), action_names
                (with unit, lowest and highest: the values of an action of -1 and 1); near, residual
                and orca (see `ResidualConfig`); activation (tanh or relu), clip; versions
    mean, std   (inputs,) float64, of observations: the input of the network is
                (observation - mean) / std, clipped to -clip to clip
    weights_k   (inputs, outputs) float64 of layer k from 0 on
    offsets_k   (outputs,) float64

The output of the last layer, clipped to [-1, 1], is the action, unless `ResidualConfig` says
otherwise. All other layers have the activation. The number of neighbors is fixed; missing neighbors
are zeros, as in the simulator.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.archive import Archive
from fgenv.arrays import Floats

ACTIVATIONS = ("tanh", "relu")
REQUIRED = {"observation", "parts", "actions", "action_names", "near", "activation", "clip"}


class PolicyError(ValueError):
    """An invalid policy file, with the reason and the remedy."""


ARCHIVE = Archive("policy", 1, ("about",), PolicyError, "train or get it again")


@dataclass(frozen=True, eq=False)
class PolicyFile:
    """Contents of a policy file; see the module.

    Attributes:
        about: plain values.
        mean, std: (inputs,).
        layers: weights (inputs, outputs) and offsets (outputs,) of each.
    """

    about: dict[str, Any]
    mean: Floats
    std: Floats
    layers: tuple[tuple[Floats, Floats], ...]

    def __post_init__(self) -> None:
        missing = sorted(REQUIRED - self.about.keys())
        if missing:
            raise PolicyError(f"policy: {', '.join(missing)} missing; train it again")
        self._check_normalization()
        self._check_layers()
        if self.about["activation"] not in ACTIVATIONS:
            raise PolicyError(
                f"policy: activation: got {self.about['activation']!r}, expected"
                f" {' or '.join(ACTIVATIONS)}"
            )

    def _check_normalization(self) -> None:
        size = self._inputs
        if self.mean.shape != (size,) or self.std.shape != (size,) or not (self.std > 0).all():
            raise PolicyError(f"policy: mean, std: expected ({size},), std over 0")
        if not np.isfinite([self.mean, self.std]).all():
            raise PolicyError("policy: mean, std: expected finite numbers")

    def _check_layers(self) -> None:
        ends = [(weights.shape[0], len(offsets)) for weights, offsets in self.layers]
        drive, actions = self.about["actions"] == "drive", len(self.about["action_names"])
        if not ends or ends[0][0] != self._inputs or (drive and ends[-1][1] != actions):
            sizes = f"from {ends[0][0]} to {ends[-1][1]} numbers" if ends else "none"
            raise PolicyError(
                f"policy: layers: got {sizes}, expected from {self._inputs} to {actions}"
            )

    @property
    def _inputs(self) -> int:
        return sum(size for _, size in self.about["parts"])

    @property
    def arrays(self) -> dict[str, Floats]:
        """Stored arrays by name."""
        arrays = {"mean": self.mean, "std": self.std}
        for k, (weights, offsets) in enumerate(self.layers):
            arrays |= {f"weights_{k}": weights, f"offsets_{k}": offsets}
        return arrays

    @property
    def texts(self) -> dict[str, str]:
        """Stored texts: `about`."""
        return {"about": json.dumps(self.about, sort_keys=True, separators=(",", ":"))}

    @cached_property
    def id(self) -> str:
        """Hash of the contents, 64 hexadecimal digits."""
        return ARCHIVE.id(self.texts, self.arrays)

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; an existing file is replaced atomically.

        Raises:
            ValueError: the name does not end in .npz.
            OSError: the file cannot be written.
        """
        ARCHIVE.save(path, self.texts, self.arrays)

    @classmethod
    def load(cls, path: str | Path) -> PolicyFile:
        """Read and verify a file.

        Raises:
            PolicyError: not a policy, damaged, or of another version.
            FileNotFoundError: no such file.
        """

        def read(texts: dict[str, str], arrays: dict[str, Floats]) -> PolicyFile:
            count = sum(name.startswith("weights_") for name in arrays)
            layers = tuple((arrays[f"weights_{k}"], arrays[f"offsets_{k}"]) for k in range(count))
            return cls(json.loads(texts["about"]), arrays["mean"], arrays["std"], layers)

        return ARCHIVE.load(path, read)
