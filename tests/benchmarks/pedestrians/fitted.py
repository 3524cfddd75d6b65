"""The part of the page on ``people``: options that were fitted to one recording, in all of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

from irsim.bridges.pedestrians.cases import Cases, read_cases
from irsim.bridges.pedestrians.imitation import GOALS, RADIUS, goals_of, imitate
from irsim.bridges.pedestrians.likeness import Likeness, contacts, likeness
from irsim.components.behaviors._people import FITTED, People
from tests.benchmarks.pedestrians.fit import distance
from tests.benchmarks.pedestrians.human import FILES

NOT_SHIPPED = {
    "sfm": {
        "relaxation_time": 0.454,
        "force_factor_social": 11.3,
        "lambda_importance": 0.936,
        "gamma": 0.0813,
        "n_angular": 0.478,
        "n_velocity": 7.06,
    },
    "orca": {"timeHorizon": 0.564, "safe_radius": 0.0753, "neighborDist": 8.77},
}
"""The options that the search found in hotel: they are worse than the defaults in the other recordings."""


def parts(data: Path) -> dict[str, str]:
    """The text of this part of the page."""
    recordings = {name.lower(): read_cases(data / file) for name, file in FILES.items()}
    return {
        f"fitted_{behavior}": f"**`{behavior}`**\n\n" + "\n".join(table(recordings, behavior)) for behavior in FITTED
    }


def table(recordings: dict[str, Cases], behavior: str) -> list[str]:
    """The defaults of a behavior and each set of options, in some recordings."""
    heads = ("fitted to", "tested on", "ADE [m]", "FDE [m]", "contacts", "recorded", "nearest [m]", "speed [m/s]")
    heads += ("distance", "ADE, goal extrapolated [m]")
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    sets: dict[str, dict[str, Any]] = {"defaults": {}, **{name: {"people": name} for name in FITTED[behavior]}}
    sets["hotel"] = NOT_SHIPPED[behavior]
    for fitted_to, options in sets.items():
        for name, cases in recordings.items():
            known, blind = (
                likeness(cases, imitate(cases, {"name": behavior, **options}, goals_of(cases, goal)), RADIUS)
                for goal in GOALS
            )
            lines.append(_line(fitted_to, name, known, blind, contacts(cases, cases.truth, RADIUS)))
    return lines


def _line(fitted_to: str, name: str, known: Likeness, blind: Likeness, recorded: float) -> str:
    cells = [
        f"`people: {fitted_to}`" if fitted_to in get_args(People) else fitted_to,
        f"**{name}**" if fitted_to == name else name,
        f"{known.ade:.2f}",
        f"{known.fde:.2f}",
        f"{known.contacts:.1%}",
        f"{recorded:.1%}",
        f"{known.nearest:.3f}",
        f"{known.speed:.3f}",
        f"{distance(known, recorded):.3f}",
        f"{blind.ade:.2f}",
    ]
    return f"| {' | '.join(cells)} |"
