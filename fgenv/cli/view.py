"""``fgenv view``: an episode of a scenario, live in the browser."""

from __future__ import annotations

import webbrowser
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.options import Seed
from fgenv.cli.run import names, policies
from fgenv.cli.scenarios import given

if TYPE_CHECKING:
    from fgenv.envs import Simulator
    from fgenv.view.web.live import Live

PORT = 8080
END = 3.0  # seconds that the end of an episode is shown


def view(
    context: typer.Context,
    scenario: Annotated[
        str,
        typer.Argument(
            help="A built-in scenario (see fgenv scenarios), a scenario file, or a frozen set.",
            autocompletion=names,
        ),
    ],
    policy: Annotated[
        str,
        typer.Option("--policy", help="What acts, as in fgenv run.", autocompletion=policies),
    ] = "goto",
    n: Annotated[int | None, typer.Option("--n", min=1, help="Robots.")] = None,
    size: Annotated[float | None, typer.Option("--size", help="Meters; see the scenario.")] = None,
    set: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="What is the scenario's own: jitter=0.1."),
    ] = None,
    port: Annotated[
        int,
        typer.Option("--port", min=0, max=65535, help="Of the page; 0: any that is free."),
    ] = PORT,
    open_it: Annotated[
        bool, typer.Option("--open", help="Open the page in the browser there is.")
    ] = False,
    episodes: Annotated[
        int | None,
        typer.Option("--episodes", min=1, help="End after so many.", show_default="on and on"),
    ] = None,
    seed: Seed = 0,
) -> None:
    """Watch episodes of a scenario live in the browser.

    The page is for this machine alone, at the port that is asked for and no
    other. Its panel pauses, steps, sets the speed, follows a robot, and shows
    feature points and graphs, motion boxes (of each robot's next second) and
    the masks that they set, lidar rays, clearances, contacts. What bears a
    robot's mask bit is light blue, with a line from that robot; Whose chooses
    one robot to show these of. Ctrl-C ends it.
    """
    from fgenv.cli.episode import EpisodeOptions, simulator_of, strictly
    from fgenv.envs import policy_of
    from fgenv.view.web.live import Live

    acting = policy_of(policy, seed)
    strictly(acting)
    overrides = given(n, size, set or [])
    options = EpisodeOptions(scenario, policy, overrides, seed, None, None, None, None)
    simulator = simulator_of(context, options, acting)
    live = Live(simulator, port)
    typer.echo(f"{simulator.scenario.name}: live at {live.url} (Ctrl-C ends it)")
    if open_it and not webbrowser.open(live.url):
        typer.echo("no browser was found; open it yourself")
    try:
        watch(live, simulator, acting, seed, episodes)
    finally:
        live.close()


def watch(
    live: Live, simulator: Simulator, policy: Any, seed: int, episodes: int | None = None
) -> None:
    """Episodes one after another, each shown; the first is the seed's first."""
    from fgenv.envs import View

    done = 0
    while episodes is None or done < episodes:
        observations = simulator.reset(seed=seed if done == 0 else None)
        policy.reset(View(simulator))
        live.begin()
        while not live.panel.restart.is_set():
            step = simulator.step(policy.act(observations))
            observations = step.observations
            live.show()
            if step.terminated[0] or step.truncated[0]:
                live.rest(END)
                break
        done += 1
