"""``irsim run``: simulate one episode."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irsim.cli.guard import FAILED
from irsim.cli.options import File, Imports, Json, MaxObjects, Seed, Steps, Strict

if TYPE_CHECKING:
    from rich.console import Console

    from irsim.results.run import RunResult

__all__ = ["run", "show_result"]

_MANY = 12  # robots listed one by one
_COLORS = {"success": "green", "collision": "red", "timeout": "yellow"}


def run(
    file: File,
    seed: Seed = None,
    steps: Steps = None,
    json_output: Json = False,
    save_gif: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Also write an animation: .gif, .mp4 or .apng.")
    ] = None,
    show: Annotated[bool, typer.Option("--show", help="Watch it live in a window.")] = False,
    strict: Strict = False,
    behavior: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Replace every robot's behavior: rvo, or '{name: orca, timeHorizon: 5}'.",
            show_default=False,
        ),
    ] = None,
    imports: Imports = None,
    require_success: Annotated[
        bool, typer.Option("--require-success", help="Exit with 1 unless every robot reaches its goal.")
    ] = False,
    record: Annotated[
        bool,
        typer.Option(
            "--record",
            help="Keep everything that happens, for `irsim inspect` and `replay`: 24 hours, below .irsim/runs.",
        ),
    ] = False,
    record_to: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Keep it in a new folder instead, for good.", show_default=False)
    ] = None,
    max_objects: MaxObjects = None,
) -> None:
    """Simulate a scenario until every robot has arrived or collided, or time is up.

    A collision or a time-out is a result like any other: the exit code is 0 unless --require-success is given.
    """
    from irsim.cli.findings import import_user_modules, limits_for, print_findings
    from irsim.cli.output import console, print_json, progress

    import_user_modules(imports)
    if show:
        _mention_missing_screen()
    with progress("simulating" if save_gif is None else "simulating and drawing") as report:
        from irsim import api
        from irsim.common.files import check_suffix

        if save_gif is not None:
            check_suffix(save_gif, api.VIDEO_SUFFIXES)
        result = api.run(
            file,
            seed=seed,
            steps=steps,
            strict=strict,
            behavior=behavior,
            imports=imports or (),
            save=save_gif,
            show=show,
            record=record if record_to is None else record_to,
            limits=limits_for(max_objects),
            progress=report,
        )
    if json_output:
        print_json(result)
    else:
        print_findings(result.warnings, file, stderr=True)
        show_result(result, console())
    if require_success and result.outcome != "success":
        raise typer.Exit(FAILED)


def show_result(result: RunResult, out: Console, again: str | None = None) -> None:
    """Print how an episode ended.

    Args:
        result: From :func:`irsim.run`.
        out: Where to.
        again: Command that repeats it, if another than the result's own.
    """
    from rich.text import Text

    from irsim.common.text import clean, seconds

    if result.robots:
        out.print(_table(result))
    if len(result.robots) > _MANY:
        out.print(f"... and {len(result.robots) - _MANY} more robots (--json lists all)")
    out.print(Text.assemble((result.outcome, f"bold {_COLORS[result.outcome]}"), ": ", clean(result.summary, 400)))
    if result.reason and result.reason not in result.summary:
        out.print(f"why: {clean(result.reason, 400)}")
    limit = {
        "argument": "--steps",
        "scenario": "the scenario",
        "default": "default: set world.time_limit",
        "limits": "the most steps of one run",
    }
    horizon = f"{seconds(result.time_limit)} ({limit[result.time_limit_from]})"
    out.print(f"{result.steps} steps, {seconds(result.sim_time)} of at most {horizon}")
    for written in result.files:
        out.print(Text.assemble("wrote ", (written, "bold")), soft_wrap=True)
    if result.run_id is not None:
        folder = Path(next(iter(result.artifacts.values()))).parent
        name = result.run_id if folder.parent.parent.name == ".irsim" else shlex.quote(str(folder))
        out.print(
            Text.assemble("recorded: ", (f"irsim inspect {name}", "cyan"), " or ", (f"irsim replay {name}", "cyan")),
            soft_wrap=True,
        )
    for note in result.notes:
        out.print(f"note: {note}", style="yellow")
    out.print(Text.assemble("again: ", (again or result.reproduce, "cyan")), soft_wrap=True)


def _mention_missing_screen() -> None:
    from irsim.graphics.figure.window import has_screen

    if not has_screen():
        typer.echo("there is no screen here, so no window opens; --save-gif leaves a film", err=True)


def _table(result: RunResult) -> object:
    from rich.table import Table
    from rich.text import Text

    from irsim.common.text import clean, seconds

    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("robot", "outcome"):
        table.add_column(heading)
    for heading in ("arrived", "travelled", "to goal", "collisions"):
        table.add_column(heading, justify="right")
    for robot in result.robots[:_MANY]:
        table.add_row(
            clean(robot.name, 24),
            Text(robot.outcome, style=_COLORS[robot.outcome]),
            "-" if robot.time_to_goal is None else seconds(robot.time_to_goal),
            f"{robot.path_length:.1f} m",
            "-" if robot.distance_to_goal is None else f"{robot.distance_to_goal:.2f} m",
            str(robot.collision_count),
        )
    return table
