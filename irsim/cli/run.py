"""``irsim run``: simulate one episode."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Collection
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from irsim import api, studio
from irsim.cli.findings import import_user_modules, limits_for, print_warnings
from irsim.cli.guard import FAILED, ended_in_order
from irsim.cli.options import File, Imports, Json, MaxObjects, Perturb, Seed, Steps, Strict, Until
from irsim.cli.output import OUTCOME_COLORS, console, existing, print_error, print_json, progress, show_written
from irsim.cli.run_seeds import run_all
from irsim.common.files import check_suffix
from irsim.common.text import clean, seconds
from irsim.diagnostics.errors import InputError
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES
from irsim.results.benchmark import ending

if TYPE_CHECKING:
    from rich.console import Console

    from irsim.results.run import RunResult

__all__ = ["run", "show_result"]

MAX_ROBOTS_SHOWN = 12
"""Number of robots that the table lists."""


def run(
    file: File,
    seed: Seed = None,
    seeds: Annotated[
        str | None,
        typer.Option(
            metavar="SEEDS",
            help="Run an episode for each of several seeds: their number from 0, or a list of seeds: 20, 5-9, 1,4,7.",
            show_default=False,
        ),
    ] = None,
    steps: Steps = None,
    json_output: Json = False,
    save_gif: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Also write an animation: .gif, .mp4 or .apng.")
    ] = None,
    strict: Strict = False,
    policy: Annotated[
        str | None,
        typer.Option(
            "--policy",
            metavar="NAME",
            help="Drive every robot by this policy instead of its own behavior: a behavior such as rvo or '{name: "
            "orca, timeHorizon: 5}', a file (model.npz), a plug-in; irsim policies lists them.",
            show_default=False,
        ),
    ] = None,
    behavior: Annotated[str | None, typer.Option(metavar="NAME", help="Another name of --policy.", hidden=True)] = None,
    perturb: Perturb = None,
    until: Until = None,
    bridge: Annotated[
        list[str] | None,
        typer.Option(
            "--bridge",
            metavar="NAME",
            help="Connect to another program, besides bridges of the scenario: a name such as json_lines, or '{name: "
            'json_lines, address: "127.0.0.1:9100"}\'. Repeatable; irsim bridge doctor lists them.',
            show_default=False,
        ),
    ] = None,
    imports: Imports = None,
    require_success: Annotated[
        bool, typer.Option("--require-success", help="Exit with code 1 unless every robot reaches its goal.")
    ] = False,
    record: Annotated[
        bool,
        typer.Option(
            "--record", help="Record the run in .irsim/runs for 24 hours, for `irsim inspect` and `irsim replay`."
        ),
    ] = False,
    record_to: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Record the run in this new folder instead, permanently.", show_default=False),
    ] = None,
    export: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Also write the run for another program; the suffix selects the format, as in `irsim export`. "
            "Repeatable.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files of --export that exist.")] = False,
    max_objects: MaxObjects = None,
    show: Annotated[bool, typer.Option("--show", help="Show the simulation in a window of Matplotlib.")] = False,
    watch: Annotated[
        bool,
        typer.Option(
            "--watch",
            help="Show the run in a browser while it is simulated: pause, step, scrub, follow a robot. The page stays "
            "when the run is over; Ctrl-C or closing it ends the command.",
        ),
    ] = False,
    speed: Annotated[
        float | None,
        typer.Option(
            min=0.1,
            max=100,
            help="With --watch or --show: how many times as fast as in reality. Default: 1.",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=65535,
            help="With --watch: port of the page on this machine. Default: a free one.",
            show_default=False,
        ),
    ] = None,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="With --watch: print the address only, and open no browser.")
    ] = False,
) -> None:
    """Simulate a scenario until every robot has arrived or collided, or the time limit is reached.

    The exit code is 0 also after a collision or a time-out, unless --require-success is given. It is 1 if the policy or
    the program of a bridge was lost.
    """
    import_user_modules(imports)
    shared: dict[str, Any] = {
        "steps": steps,
        "strict": strict,
        "policy": policy,
        "behavior": behavior,
        "perturb": perturb,
        "until": until,
        "imports": imports or (),
        "limits": limits_for(max_objects),
    }
    if seeds is not None:
        single = {"--seed": seed, "--save-gif": save_gif, "--show": show, "--watch": watch, "--bridge": bridge}
        single |= {"--record-to": record_to}
        run_all(
            file,
            seeds,
            {**single, "--export": export},
            json_output=json_output,
            require_success=require_success,
            record=record,
            **shared,
        )
        return
    if show:
        _mention_missing_screen()
    window = _window(watch=watch, show=show, speed=speed, port=port, no_browser=no_browser)
    before = existing(save_gif, *(export or ()))
    with ended_in_order(), window or nullcontext():
        with progress("simulating" if save_gif is None else "simulating and drawing") as report:
            if save_gif is not None:
                check_suffix(save_gif, MOVING_SUFFIXES)
            result = api.run(
                file,
                seed=seed,
                bridges=bridge or (),
                save=save_gif,
                show=show,
                speed=speed or 1.0,
                record=record if record_to is None else record_to,
                export=export or (),
                overwrite=force,
                progress=report,
                watched=None if window is None else window.follow,
                **shared,
                connected=None if json_output else partial(typer.echo, err=True),
            )
        if json_output:
            print_json(result)
        else:
            print_warnings(result.warnings, file)
            show_result(result, console(), before=before)
        if window is not None:
            window.end(result)
            sys.stdout.flush()
            window.wait()
    if result.lost is not None:
        print_error(result.lost_code or "", f"{result.lost}; the run ended after {seconds(result.sim_time)}")
        raise typer.Exit(FAILED)
    if require_success and result.outcome != "success":
        raise typer.Exit(FAILED)


def _window(
    *, watch: bool, show: bool, speed: float | None, port: int | None, no_browser: bool
) -> studio.Window | None:
    """The page of --watch, None without it.

    Raises:
        InputError: An option needs --watch, or another one that is not given.
    """
    if not watch:
        if port is not None or no_browser:
            name = "--port" if port is not None else "--no-browser"
            raise InputError(f"{name} is about the page of --watch", "add --watch, or leave it out")
        if speed is not None and not show:
            raise InputError("--speed is about what is shown", "add --watch or --show, or leave it out")
        return None
    return studio.Window(partial(typer.echo, err=True), port=port or 0, browser=not no_browser, speed=speed)


def show_result(result: RunResult, out: Console, again: str | None = None, before: Collection[str] = ()) -> None:
    """Print how an episode ended.

    Args:
        result: Result of :func:`irsim.run`.
        out: Console to print to.
        again: Command that reproduces the episode; default: the one in the result.
        before: Files that existed before the run.
    """
    if result.robots:
        out.print(_table(result))
    if len(result.robots) > MAX_ROBOTS_SHOWN:
        out.print(f"... and {len(result.robots) - MAX_ROBOTS_SHOWN} more robots (--json lists all)")
    ended = Text(ending(result.outcome, result.lost), style=f"bold {OUTCOME_COLORS[result.outcome]}")
    out.print(Text.assemble(ended, ": ", clean(result.summary, 400)))
    if result.reason and result.reason not in result.summary:
        out.print(f"reason: {clean(result.reason, 400)}")
    limit = {
        "argument": "from --steps",
        "scenario": "from the scenario",
        "default": "default; set world.time_limit to change it",
        "limits": "maximum of one run",
    }
    horizon = f"{seconds(result.time_limit)} ({limit[result.time_limit_from]})"
    out.print(f"{result.steps} steps, {seconds(result.sim_time)} of simulated time; time limit {horizon}")
    for written in result.files:
        show_written(written, before=before)
    if result.run_id is not None:
        folder = Path(next(iter(result.artifacts.values()))).parent
        name = result.run_id if folder.parent.parent.name == ".irsim" else shlex.quote(str(folder))
        out.print(
            Text.assemble("recorded: ", (f"irsim inspect {name}", "cyan"), " or ", (f"irsim replay {name}", "cyan")),
            soft_wrap=True,
        )
    for note in result.notes:
        out.print(f"note: {note}", style="yellow")
    out.print(Text.assemble("reproduce: ", (again or result.reproduce, "cyan")), soft_wrap=True)


def _mention_missing_screen() -> None:
    from irsim.graphics.figure.window import has_screen  # loads Matplotlib

    if not has_screen():
        typer.echo("no window can be opened, because there is no screen; --save-gif writes an animation", err=True)


def _table(result: RunResult) -> object:
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("robot", "outcome"):
        table.add_column(heading)
    between = any(robot.contacts_between_steps for robot in result.robots)
    laps = any(robot.laps is not None for robot in result.robots)
    for heading in ("arrived", *["laps"] * laps, "travelled", "to goal", "collisions", *["between steps"] * between):
        table.add_column(heading, justify="right")
    for robot in result.robots[:MAX_ROBOTS_SHOWN]:
        table.add_row(
            clean(robot.name, 24),
            Text(robot.outcome, style=OUTCOME_COLORS[robot.outcome]),
            "-" if robot.time_to_goal is None else seconds(robot.time_to_goal),
            *["-" if robot.laps is None else str(robot.laps)] * laps,
            f"{robot.path_length:.1f} m",
            "-" if robot.distance_to_goal is None else f"{robot.distance_to_goal:.2f} m",
            str(robot.collision_count),
            *[Text(str(robot.contacts_between_steps), "red" if robot.contacts_between_steps else "dim")] * between,
        )
    return table
