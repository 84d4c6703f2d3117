"""Trained policies as files: a network and all that is needed to use it, without PyTorch.

A NumPy `.npz` (a zip of arrays; `numpy.load` reads it), compressed:

    format      "fgenv policy 1"
    id          SHA-256 of all the rest, little-endian: 64 hexadecimal digits
    about       JSON: name, command, seed, scenario (name and overrides that it was trained with),
                steps; observation (what `fgenv.envs.Observation` takes), parts (name and size of
                each part of a row, in order), actions (drive or way_points), action_names (with
                unit, lowest and highest: an action of -1 and 1); near; activation (tanh or relu),
                clip; versions
    mean, std   (inputs,) float64, of the rows of observations: the network sees
                (row - mean) / std, brought to -clip to clip
    weights_k   (inputs, outputs) float64 of layer k from 0 on
    offsets_k   (outputs,) float64

The last layer's output, brought to [-1, 1], is the action; but who is nearer than `near` to its
goal (metres; of a fixed base radians of all joints) does what `goto` does. All other layers have
the activation. Arrays are little-endian. There is a fixed number of neighbours; where a scenario
has fewer robots the missing ones are zeros, as a simulator gives them.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

FORMAT = "fgenv policy 1"
ACTIVATIONS = ("tanh", "relu")
Floats = NDArray[np.float64]


class PolicyError(ValueError):
    """A policy's file that cannot be used: why, and the remedy."""


@dataclass(frozen=True, eq=False)
class PolicyFile:
    """What is in a file; see the module.

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
        size = sum(size for _, size in self.about["parts"])
        if self.mean.shape != (size,) or self.std.shape != (size,) or not (self.std > 0).all():
            raise PolicyError(f"policy: mean, std: wanted ({size},), std over 0")
        if self.about["activation"] not in ACTIVATIONS:
            said = self.about["activation"]
            raise PolicyError(f"policy: activation: {said!r}, wanted {' or '.join(ACTIVATIONS)}")

    @property
    def arrays(self) -> dict[str, Floats]:
        """What is hashed and stored, little-endian."""
        found = {"mean": self.mean, "std": self.std}
        for k, (weights, offsets) in enumerate(self.layers):
            found |= {f"weights_{k}": weights, f"offsets_{k}": offsets}
        return {name: np.ascontiguousarray(x, dtype="<f8") for name, x in found.items()}

    @cached_property
    def text(self) -> str:
        """What is said about it, as it is stored."""
        return json.dumps(self.about, sort_keys=True, separators=(",", ":"))

    @cached_property
    def id(self) -> str:
        """Hash of all that is in it, 64 hexadecimal digits."""
        found = hashlib.sha256(f"{FORMAT}\nabout {len(self.text)}\n{self.text}\n".encode())
        for name, array in self.arrays.items():
            found.update(f"{name} {array.shape}\n".encode() + array.tobytes())
        return found.hexdigest()

    def save(self, path: str | Path) -> None:
        """Write a compressed .npz file; one that is there is replaced in one go.

        Raises:
            ValueError: its name does not end in .npz.
            OSError: it cannot be written.
        """
        path = Path(path)
        if path.suffix != ".npz":
            raise ValueError(f"policy: {path}, wanted a name that ends in .npz")
        half = path.with_name(f".{path.name}.part")
        head = {"format": FORMAT, "id": self.id, "about": self.text}
        try:
            with open(half, "wb") as file:
                np.savez_compressed(file, **head, **self.arrays)  # type: ignore[arg-type]
            os.replace(half, path)
        finally:
            half.unlink(missing_ok=True)

    @classmethod
    def load(cls, path: str | Path) -> PolicyFile:
        """Read and verify a file.

        Raises:
            PolicyError: no policy, damaged, or of another version.
            FileNotFoundError: no such file.
        """
        damaged = PolicyError(f"{path}: is damaged, or no policy; train or get it again")
        try:
            with np.load(path, allow_pickle=False) as file:
                said = str(file["format"])
                if said.startswith("fgenv policy ") and said != FORMAT:
                    told = f"{path}: is {said!r}, wanted {FORMAT!r}"
                    raise PolicyError(f"{told}; use the fgenv that wrote it, or train it again")
                count = sum(name.startswith("weights_") for name in file.files)
                layers = tuple((file[f"weights_{k}"], file[f"offsets_{k}"]) for k in range(count))
                about = json.loads(str(file["about"]))
                found = cls(about, file["mean"], file["std"], layers)
                if said != FORMAT or str(file["id"]) != found.id:
                    raise damaged
                return found
        except (FileNotFoundError, IsADirectoryError, PermissionError, PolicyError):
            raise
        except Exception as error:  # zip, zlib, NumPy and JSON each have their own
            raise damaged from error
