"""``fgenv bench``: benchmarks against other libraries."""

import typer

from fgenv.cli import (
    bench_env,
    bench_files,
    bench_fleets,
    bench_limits,
    bench_pairs,
    bench_planners,
    bench_policies,
    bench_train,
    bench_world,
)

app = typer.Typer(
    name="bench",
    help="Compare fgenv with other libraries. Each benchmark has its own options, --seed and "
    "--json among them: fgenv bench pairs --help, fgenv bench env --help.",
    rich_markup_mode="rich",
    no_args_is_help=True,
)
app.command()(bench_world.world)
app.command()(bench_env.env)
app.command()(bench_planners.planners)
app.command()(bench_fleets.fleets)
app.command()(bench_train.train)
app.command()(bench_policies.policies)
app.command()(bench_pairs.pairs)
app.command()(bench_limits.limits)
app.command()(bench_files.files)
