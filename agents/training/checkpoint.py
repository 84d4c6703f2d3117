"""Files of a training: the best policy, the state to resume from, and the evaluations."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from fgenv.agents.policies.residual import ResidualConfig
from fgenv.agents.training.validation import EvaluationResult
from fgenv.regular_file import read_regular
from fgenv.saving import save_text

MAX_BYTES = 1 << 24
COLUMNS = tuple(column.name for column in fields(EvaluationResult))


@dataclass(frozen=True)
class Checkpoint:
    """Files in the folder of a training; see `fgenv.agents.training.training`."""

    folder: Path

    @property
    def policy(self) -> Path:
        """File of the best policy."""
        return self.folder / "policy.npz"

    @property
    def model(self) -> Path:
        """File of the model of Stable-Baselines3."""
        return self.folder / "model.zip"

    @property
    def normalization(self) -> Path:
        """File of the `VecNormalize`."""
        return self.folder / "model.pkl"

    @property
    def _settings(self) -> Path:
        return self.folder / "model.json"

    @property
    def _state(self) -> Path:
        return self.folder / "training.json"

    @property
    def _evaluations(self) -> Path:
        return self.folder / "evaluations.csv"

    def begin(self) -> None:
        """Remove an older training, which could otherwise be resumed, and begin a new one."""
        for path in (self._state, self.model, self.normalization, self._settings, self.policy):
            path.unlink(missing_ok=True)
        save_text(self._evaluations, ",".join(COLUMNS) + "\n")

    def append(self, result: EvaluationResult) -> None:
        """Append an evaluation to the table."""
        steps, *numbers = asdict(result).values()
        with self._evaluations.open("a", encoding="utf-8") as table:
            table.write(f"{steps}," + ",".join(f"{x:.4f}" for x in numbers) + "\n")

    def save_settings(self, about: Mapping[str, Any]) -> None:
        """Write the settings of the model that `Sb3Policy` reads."""
        names = ("observation", "actions", *(key.name for key in fields(ResidualConfig)))
        settings = {name: about[name] for name in names}
        save_text(self._settings, json.dumps(settings))

    def _read_state(self) -> dict[str, Any]:
        try:
            state = json.loads(read_regular(self._state, "the state of a training", MAX_BYTES))
            return {"steps": int(state["steps"]), "best": state["best"], **state}
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            text = f"--resume: {self._state} is damaged ({error}); omit --resume"
            raise ValueError(text) from None

    def save_state(
        self, settings: Mapping[str, Any], steps: int, best: EvaluationResult | None
    ) -> None:
        """Write the state of the training, atomically."""
        state = {**settings, "steps": steps, "best": best and asdict(best)}
        save_text(self._state, json.dumps(state, indent=1, default=list) + "\n")

    def load_state(self, settings: Mapping[str, Any]) -> tuple[int, EvaluationResult | None]:
        """Return steps and best evaluation of a training with the same settings.

        Raises:
            ValueError: no training, or other settings.
        """
        if not self._state.exists():
            raise ValueError(f"--resume: got {self.folder}, which has no training; omit --resume")
        state = self._read_state()
        for name, value in json.loads(json.dumps(settings, default=list)).items():
            if state.get(name) != value:
                raise ValueError(
                    f"--resume: {name}: got another value, expected {state.get(name)} as before;"
                    " or omit --resume"
                )
        return state["steps"], state["best"] and EvaluationResult(**state["best"])
