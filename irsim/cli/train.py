"""``irsim train``: train a policy for a task."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from irsim.cli.findings import print_findings
from irsim.cli.guard import INVALID, again, going_on
from irsim.cli.options import seed_option
from irsim.cli.output import console, show_written
from irsim.common.extras import require
from irsim.learning.tasks.files import open_task
from irsim.learning.training.run_folder import RunFolder
from irsim.learning.training.settings import read_settings
from irsim.validation.file_reports import task_report

__all__ = ["SARL_SETTINGS", "SETTINGS", "train"]

SETTINGS = (
    "Their defaults: slots=128, rollout=64, batch=1024, epochs=6, rate=0.0007, gamma=0.98, gae_lambda=0.95, clip=0.2, "
    "entropy=0.002, units=[128, 128], set_units=[64, 64], "
    "set_reader=pool, log_std=-0.5, round_updates=8."
)
"""Help on the settings; a literal, so that the help needs no pydantic."""
SARL_SETTINGS = (
    "With --algo sarl: demonstrations=2000, demonstration_epochs=20, slots=100, batch=500, updates=100, "
    "round_episodes=10, memory=100000, rate=0.001, decay=1e-05, gamma=0.9, explore=0.5, explore_end=0.1, "
    "explore_until=0.4, target_updates=200, global_state=True, embed_units=[150, 100], feature_units=[100, 50], "
    "score_units=[100, 100], value_units=[150, 100, 100], speeds=5, headings=16, dt=0.25, gap=end."
)
"""The same for value networks."""


_LIBRARIES = ("torch", "stable_baselines3", "tensorboard", "gymnasium")
"""Packages that training needs besides irsim; each is checked before one of them is imported."""


def train(
    task: Annotated[
        Path | None,
        typer.Argument(
            metavar="TASK",
            help="Task file, or the name of a bundled task; a resumed training has its own.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FOLDER", help="Folder of the training.")] = Path(
        "training"
    ),
    algo: Annotated[str | None, typer.Option("--algo", help="Algorithm: ppo, which is the default, or sarl.")] = None,
    steps: Annotated[
        float | None,
        typer.Option(
            "--decisions",
            min=1,
            help="Decisions of all learners, at most, such as 5e6; with --resume a finished training goes on to them. "
            "Default: 1e6; 450,000 after the demonstrations with sarl.",
        ),
    ] = None,
    max_time: Annotated[
        float | None,
        typer.Option("--max-time", min=0, metavar="SECONDS", help="Begin no further round after this wall-clock time."),
    ] = None,
    seed: Annotated[
        int | None,
        seed_option("Random seed of weights, exploration and samples, 0 or more. Default: 0.", largest=2**32 - 1),
    ] = None,
    stop_at: Annotated[
        float | None,
        typer.Option("--stop-at", min=0, max=1, help="Stop at this success on the validation seeds, such as 0.98."),
    ] = None,
    options: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help=f"Set KEY to VALUE, another setting. Repeatable. {SETTINGS} {SARL_SETTINGS}",
        ),
    ] = None,
    threads: Annotated[int, typer.Option("--threads", min=1, help="Threads of simulation and torch.")] = 1,
    workers: Annotated[
        int,
        typer.Option(
            "--workers", min=1, max=256, help="Processes that ppo divides the simulation among; results stay the same."
        ),
    ] = 1,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the training in the folder.")] = False,
) -> None:
    """Train a policy for a task; needs the extra `learn`. Success is measured on seeds that are not trained on."""
    if (task is None) != resume:
        what = "a task file is missing" if task is None else "a resumed training has its own task"
        typer.echo(f"{what}: give TASK, or --resume with -o FOLDER", err=True)
        raise typer.Exit(INVALID)
    wanted = None if steps is None else int(steps)
    given = {"algo": algo, "steps": wanted, "seed": seed, "stop_at": stop_at}
    if resume and (options or any(given[name] is not None for name in ("algo", "seed", "stop_at"))):
        typer.echo("a resumed training keeps its settings, except --decisions: leave out the others", err=True)
        raise typer.Exit(INVALID)
    settings = RunFolder(out).settings() if resume else read_settings(given, options or [])
    if settings.algo == "sarl" and workers > 1:
        typer.echo("--workers is for --algo ppo, and this training uses sarl: leave it out", err=True)
        raise typer.Exit(INVALID)
    if task is not None:
        open_task(str(task))  # a wrong name is said before what training needs
    require("learn", *(("torch",) if settings.algo == "sarl" else _LIBRARIES))
    _let_threads_sleep()
    run: Any
    more: dict[str, Any] = {}
    if settings.algo == "sarl":
        from irsim.learning.training.sarl.train import train_sarl as run
    else:
        from irsim.learning.training.train import train as run

        more = {"workers": workers}
    if task is not None:
        print_findings(
            [one for one in task_report(str(task)).findings if one.severity == "warning"], str(task), stderr=True
        )
    out_console = console()
    show: Any = _Progress(out_console)
    with going_on(lambda: _go_on(out, threads, workers)):
        best = run(
            task or out / "task.yaml", out, settings, resume=resume, steps=wanted if resume else None,
            max_time=max_time, threads=threads, on_round=show, **more,
        )  # fmt: skip
    show_written(best, "the best model")
    out_console.print(f"next: irsim export-policy {out} -o policy.npz makes a file that needs no torch", soft_wrap=True)


def _go_on(out: Path, threads: int, workers: int) -> str:
    """How an interrupted training goes on."""
    if not RunFolder(out).has_rounds():
        return f"no round was finished; again: {again()}"
    how = ["-o", str(out)]
    for option, value in (("--threads", threads), ("--workers", workers)):
        how += [option, str(value)] if value > 1 else []
    return f"finished rounds are kept; go on: {shlex.join(['irsim', 'train', '--resume', *how])}"


def _let_threads_sleep() -> None:
    """Have threads of torch sleep while they wait, unless the user decides otherwise; torch reads it when imported.

    Otherwise they keep cores busy for which the simulation waits.
    """
    os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


class _Progress:
    """Prints a line for each round."""

    def __init__(self, out: Any) -> None:
        self._out = out

    def __call__(self, made: Any) -> None:
        left = made.seconds / made.number * (made.rounds - made.number)
        success = made.success
        parts = [
            f"round {made.number}/{made.rounds}",
            f"{made.steps:,} decisions",
            f"{made.seconds:.0f} s, up to {left:.0f} s left",
            f"success {100 * success.learners:.1f} %",
            f"collided {100 * success.collided:.1f} %",
            f"reward {success.reward:.2f}",
        ]
        self._out.print("  ".join(parts) + ("  best" if made.best else ""), highlight=False)
