"""Episodes of one world, with a record."""

from __future__ import annotations

from collections.abc import Callable

from fgenv.envs import Policy, Record, Recorder, Simulator, View


def run_episode(
    simulator: Simulator,
    policy: Policy,
    *,
    seed: int | None = 0,
    steps: int | None = None,
    recorder: Recorder | None = None,
    progress: Callable[[int], object] | None = None,
) -> Record:
    """Run and record an episode.

    Args:
        simulator: of one world, with `autoreset=False`; with `clearance=True` clearances are in
            the record.
        policy: acts for all robots.
        seed: of the world; None: its next episode.
        steps: maximum number of steps; default: the horizon.
        recorder: keeps the steps so far if the episode is interrupted.
        progress: called with the number of steps so far.

    Raises:
        ValueError: several worlds, autoreset, or invalid actions.
    """
    if simulator.n_worlds != 1:
        raise ValueError(f"simulator: got {simulator.n_worlds} worlds, expected one")
    recorder = recorder or Recorder(type(policy).__name__)
    observations = simulator.reset(seed=seed)
    recorder.begin(simulator)
    policy.reset(View(simulator))
    for k in range(simulator.horizon if steps is None else steps):
        actions = policy.act(observations)
        step = simulator.step(actions)
        recorder.add(actions, step)
        if progress is not None:
            progress(k + 1)
        observations = step.observations
        if step.terminated[0] or step.truncated[0]:
            break
    return recorder.record()
