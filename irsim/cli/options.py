"""Options that several commands share."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

import typer

from irsim.common.text import clean

__all__ = ["File", "Imports", "Json", "MaxObjects", "Perturb", "Seed", "Steps", "Strict", "Until", "seed_option"]


def seed_option(about: str, *, largest: int = 2**64 - 1) -> Any:
    """The option ``--seed``: its help says which numbers it takes, and a message about another one says the largest.

    Args:
        about: The things that the seed decides, and its default.
        largest: The largest seed.
    """
    return typer.Option(
        "--seed", metavar="N", parser=partial(_whole_number, largest=largest), help=about, show_default=False
    )


def _whole_number(given: str | int, *, largest: int) -> int:
    digits = str(given)
    if digits.isascii() and digits.isdecimal() and len(digits.lstrip("0")) <= len(str(largest)):
        number = int(digits.lstrip("0") or "0")
        if number <= largest:
            return number
    raise typer.BadParameter(f"{clean(digits, 40)!r} is not a whole number from 0 to {largest}")


File = Annotated[str, typer.Argument(help="Scenario file (YAML).", show_default=False)]
Seed = Annotated[
    int | None,
    seed_option(
        "Random seed, 0 or more. Default: the seed of the scenario, otherwise a new one, which is reported.",
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
