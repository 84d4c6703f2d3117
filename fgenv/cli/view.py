"""``fgenv view``: an episode of a scenario, live in the browser."""

from __future__ import annotations

import webbrowser
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fgenv.cli.options import (
    OpenBrowser,
    PolicyName,
    Robots,
    ScenarioName,
    Seed,
    Settings,
    Size,
    Trust,
    check_trust,
)
from fgenv.cli.scenario_options import overrides_from

if TYPE_CHECKING:
    from fgenv.envs import Simulator
    from fgenv.view.web.live import Live

END = 3.0  # seconds that the end of an episode is shown
Port = Annotated[
    int,
    typer.Option("--port", min=0, max=65535, help="Port of the page; 0: any free port."),
]
Host = Annotated[
    str | None,
    typer.Option(
        "--host",
        help="Address of a network interface that other machines reach, such as 0.0.0.0; the page"
        " then needs the token of the printed address.",
        show_default="this machine alone",
    ),
]
Episodes = Annotated[
    int | None,
    typer.Option("--episodes", min=1, help="Number of episodes.", show_default="unlimited"),
]


def view(
    context: typer.Context,
    scenario: ScenarioName,
    policy: PolicyName = "goto",
    n: Robots = None,
    size: Size = None,
    set: Settings = None,
    port: Port = 8080,
    host: Host = None,
    open_it: OpenBrowser = False,
    episodes: Episodes = None,
    seed: Seed = 0,
    trust: Trust = False,
) -> None:
    """Watch episodes of a scenario live in the browser.

    Only this machine can open the page, at exactly the requested port, unless
    --host is given. Its panel pauses, steps, sets the speed, follows a robot, and shows feature
    points and graphs, motion boxes (of each robot's next second) and the masks
    that they set, lidar rays, clearances, contacts. Bodies in a robot's mask
    are light blue and linked to it by a line; Whose selects one robot to show
    these of. Ctrl-C ends the view.
    """
    from fgenv.cli.episode import EpisodeOptions, require_plan, simulator_of
    from fgenv.envs import policy_of
    from fgenv.view.web.live import Live

    check_trust(trust, [policy])
    acting = policy_of(policy, seed, trust=trust)
    require_plan(acting)
    options = EpisodeOptions(scenario, policy, overrides_from(n, size, set), seed)
    simulator = simulator_of(context, options, acting)
    live = Live(simulator, port, host=host)
    typer.echo(f"{simulator.scenario.name}: live at {live.url} (Ctrl-C ends it)")
    if open_it:
        open_page(live.url)
    try:
        show_episodes(live, simulator, acting, seed, episodes)
    finally:
        live.close()


def open_page(url: str) -> None:
    """Open a page in the default browser, or print that there is none."""
    if not webbrowser.open(url):
        typer.echo("no browser was found; open it yourself")


def show_episodes(
    live: Live, simulator: Simulator, policy: Any, seed: int, episodes: int | None = None
) -> None:
    """Run and show episodes, the first with the seed, the others with the following ones."""
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
