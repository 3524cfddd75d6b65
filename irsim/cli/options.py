"""Options that several commands share."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

__all__ = ["File", "Imports", "Json", "MaxObjects", "Perturb", "Seed", "Steps", "Strict", "Until"]

File = Annotated[str, typer.Argument(help="Scenario file (YAML).", show_default=False)]
Seed = Annotated[
    int | None,
    typer.Option(
        min=0,
        max=2**64 - 1,
        help="Random seed. Default: the seed of the scenario, otherwise a new one, which is reported.",
    ),
]
Steps = Annotated[
    int | None,
    typer.Option(min=0, help="Maximum number of steps. Default: the time limit of the scenario.", show_default=False),
]
Strict = Annotated[bool, typer.Option("--strict", help="Treat tolerated problems, such as unknown keys, as errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print only the result to standard output, as JSON.")]
Imports = Annotated[
    list[str] | None,
    typer.Option(
        "--import", metavar="MODULE", help="First import a Python module that registers behaviors. Repeatable."
    ),
]
Perturb = Annotated[
    list[str] | None,
    typer.Option(
        "--perturb",
        metavar="KEY=SPREAD,…",
        help="Let the seed change starts uniformly within spreads: position=0.1 (m, ± in x and y), heading=10deg (±), "
        "speed=10% (±), delay=2 (0 to 2 s). With objects=NAME,TAG,… only those objects. Repeatable.",
        show_default=False,
    ),
]
MaxObjects = Annotated[
    int | None,
    typer.Option(min=1, help="Maximum number of objects in a scenario. Default: 100000.", show_default=False),
]
Until = Annotated[
    Literal["done", "time_limit", "first_collision"] | None,
    typer.Option(
        help="When to end: when every robot has arrived or stopped, one with loop at the end of its first lap (done), "
        "at the time limit, so that it patrols on (time_limit), or also when a robot collides (first_collision). "
        "Default: done; of a scenario of a suite, as the suite says.",
        show_default=False,
    ),
]
