"""The `fgenv` command: one file per command, assembled here.

Command modules import heavy packages (OMPL, plotting, peers) inside their functions, so that
`fgenv --help` and tab completion respond at once.
"""

import sys
from typing import Annotated

import typer

from fgenv import __version__
from fgenv.cli import (
    bench,
    compare,
    eval,
    export,
    mesh,
    plan,
    plot,
    render,
    replay,
    robot,
    run,
    scenarios,
    train,
    validate,
    verify,
    view,
)
from fgenv.cli.console import set_quiet
from fgenv.cli.errors import BAD_INPUT, INTERRUPTED, report

EPILOG = """
[bold]Examples[/bold]
  fgenv run three_tanks                   the published experiment
  fgenv run three_tanks --mesh robot.stl  the same with your own robot
  fgenv run three_tanks --json            one JSON document for programs
  fgenv run swap --policy goto --n 4 --movie swap.gif --record swap.npz
  fgenv plan doorway --n 4 --out p.npz    timed and certified paths for all robots
  fgenv verify p.npz                      certify them again, from the file alone
  fgenv run doorway --n 4 --policy plan:p.npz
  fgenv eval swap --n 8 --set jitter=0.2 --policy orca --policy goto
  fgenv train swap --out out/swap         train a policy, then run it:
  fgenv run swap --policy mlp:out/swap/policy.npz
  fgenv view warehouse --n 16             watch an episode live in the browser
  fgenv replay swap.npz --html swap.html  a self-contained page that plays it
  fgenv render swap.npz --mp4 swap.mp4 --camera orbit
  fgenv plot swap.npz --kind clearance --out gaps.png
  fgenv scenarios                         the built-in scenarios
  fgenv scenarios swap --n 8 --save s.yaml --picture s.png
  fgenv validate s.yaml                   all errors of a scenario file
  fgenv export warehouse --to glb         a scenario for other programs
  fgenv mesh link.dae --picture link.png  what a mesh file specifies
  fgenv robot arm.urdf --srdf arm.srdf    what a robot file specifies
  fgenv compare                           accuracy and speed of each method
  fgenv bench pairs                       compare with other collision libraries
  fgenv bench world                       the same with many moving bodies
  fgenv bench env                         compare simulation steps of many robots
  fgenv bench planners                    OMPL with checks of fgenv, python-fcl, coal
  fgenv bench fleets                      compare planning methods for many robots
  fgenv --quiet eval swap --json          without progress, for scripts
  fgenv --install-completion              tab completion for your shell

[bold]Exit codes[/bold]
  0    success
  1    the command ran, and its check failed
  2    invalid use or input; stderr has the error and the remedy
  3    an error in fgenv itself (FGENV_DEBUG=1 shows the traceback)
  130  interrupted
"""

app = typer.Typer(
    name="fgenv",
    help="Exact, fast collision detection by feature graphs, for environments of many robots.",
    epilog=EPILOG,
    invoke_without_command=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(requested: bool) -> None:
    if requested:
        print(f"fgenv {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
    quiet: Annotated[
        bool,
        typer.Option("--quiet", "-q", help="Print no progress, and no tables on stderr."),
    ] = False,
) -> None:
    set_quiet(quiet)
    if context.invoked_subcommand is None:
        print(context.get_help())
        raise typer.Exit(BAD_INPUT)


app.command()(run.run)
app.command("eval")(eval.evaluate)
app.command()(train.train)
app.command()(plan.plan)
app.command()(verify.verify)
app.command()(replay.replay)
app.command()(view.view)
app.command()(render.render)
app.command()(plot.plot)
app.command()(scenarios.scenarios)
app.command()(validate.validate)
app.command()(mesh.mesh)
app.command()(robot.robot)
app.command()(export.export)
app.command()(compare.compare)
app.add_typer(bench.app)


def main() -> None:
    """Run the console script; end the process with an exit code."""
    try:
        # Not standalone: typer raises its errors instead of printing them as boxes.
        code = app(standalone_mode=False)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except Exception as error:  # becomes one readable line
        sys.exit(report(error))
    sys.exit(code)  # of typer.Exit, or None
