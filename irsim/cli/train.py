"""``irsim train``: train a policy for a task."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from irsim.cli.guard import INVALID

__all__ = ["train"]


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
    algo: Annotated[str, typer.Option("--algo", help="Algorithm: ppo.")] = "ppo",
    steps: Annotated[
        float, typer.Option("--steps", min=1, help="Decisions of all learners, at most; 5e6 is a number, too.")
    ] = 1e6,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of weights, exploration and samples.")] = 0,
    stop_at: Annotated[
        float | None,
        typer.Option("--stop-at", min=0, max=1, help="Stop at this success on the validation seeds, such as 0.98."),
    ] = None,
    options: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Another setting, such as rate=3e-4; may be repeated."),
    ] = None,
    threads: Annotated[int, typer.Option("--threads", min=1, help="Threads of simulation and torch.")] = 1,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the training in the folder.")] = False,
) -> None:
    """Train a policy for a task; needs the extra `learn`. Success is measured on seeds that are not trained on."""
    from irsim.cli.findings import print_findings
    from irsim.cli.output import console
    from irsim.learning.tasks.report import task_report
    from irsim.learning.training.run_folder import RunFolder
    from irsim.learning.training.settings import read_settings

    if (task is None) != resume:
        what = "a task file is missing" if task is None else "a resumed training has its own task"
        typer.echo(f"{what}: give TASK, or --resume with -o FOLDER", err=True)
        raise typer.Exit(INVALID)
    given = {"algo": algo, "steps": int(steps), "seed": seed, "stop_at": stop_at}
    settings = RunFolder(out).settings() if resume else read_settings(given, options or [])
    from irsim.learning.training.train import train as run

    if task is not None:
        print_findings(
            [one for one in task_report(str(task)).findings if one.severity == "warning"], str(task), stderr=True
        )
    out_console = console()
    show: Any = _Progress(out_console)
    best = run(task or out / "task.yaml", out, settings, resume=resume, threads=threads, on_round=show)
    out_console.print(f"best model: {best}; irsim export-policy {out} policy.npz makes a file that needs no torch")


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
