"""Running an episode: a policy acts until it is over."""

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
    """Run an episode of world 0, and record it.

    Args:
        simulator: with `autoreset=False`; with `clearance=True` clearances are in the record.
        policy: its actions are for all robots.
        seed: of the world; None: its next episode.
        steps: at most; as many as the horizon lets it if left out.
        recorder: takes the record; what is in it outlives an interruption.
        progress: called with the number of steps made so far.

    Raises:
        ValueError: the simulator has several worlds or resets by itself; actions of a wrong shape,
            or not finite.
    """
    if simulator.n_worlds != 1:
        raise ValueError(f"simulator: has {simulator.n_worlds} worlds, expected one")
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
