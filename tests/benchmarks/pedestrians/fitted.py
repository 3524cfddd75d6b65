"""The part of the page on ``people``: options that were fitted to one recording, in all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, get_args

from irsim.bridges.pedestrians.cases import read_cases
from irsim.bridges.pedestrians.imitation import GOALS, RADIUS
from irsim.bridges.pedestrians.likeness import contacts
from irsim.components.behaviors._people import FITTED, People
from tests.benchmarks.pedestrians.fit import distance
from tests.benchmarks.pedestrians.human import FILES
from tests.benchmarks.pedestrians.walks import Walks, cells, differences, walks_of

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


class Row(NamedTuple):
    """A set of options in a recording.

    Attributes:
        fitted_to: Recording to which the options were fitted, or ``defaults``.
        recording: The recording.
        known: People who know where they want to go.
        blind: People who go straight on.
        recorded: Share of people who touch others in the recording.
    """

    fitted_to: str
    recording: str
    known: Walks
    blind: Walks
    recorded: float


def compare(data: Path) -> dict[str, list[Row]]:
    """Behavior → the defaults and each set of options in all recordings, with both goals."""
    recordings = {name.lower(): read_cases(data / file) for name, file in FILES.items()}
    made: dict[str, list[Row]] = {}
    for behavior in FITTED:
        sets: dict[str, dict[str, Any]] = {"defaults": {}, **{name: {"people": name} for name in FITTED[behavior]}}
        sets["hotel"] = NOT_SHIPPED[behavior]
        for fitted_to, options in sets.items():
            for name, cases in recordings.items():
                known, blind = (
                    walks_of(cases, f"{behavior}, {fitted_to}", {"name": behavior, **options}, goal) for goal in GOALS
                )
                made.setdefault(behavior, []).append(
                    Row(fitted_to, name, known, blind, contacts(cases, cases.truth, RADIUS))
                )
    return made


def parts(compared: Mapping[str, Sequence[Row]]) -> dict[str, str]:
    """The text of this part of the page."""
    return {
        f"fitted_{behavior}": "\n".join([f"**`{behavior}`**\n", *table(rows)]) for behavior, rows in compared.items()
    }


def gains() -> dict[str, str]:
    """How much lower ADE is with other options, with intervals, from the kept cases."""
    pairs = {
        "horizon": ("{name: orca, timeHorizon: 2}", "orca", GOALS[0]),
        "eth_gain": ("sfm, eth", "sfm, defaults", GOALS[1]),
    }
    texts = {}
    for name, pair in pairs.items():
        rows = zip(FILES, differences(*pair).values(), strict=True)
        texts[name] = ", ".join(
            f"{-mean:.3f} m [{-high:.3f}, {-low:.3f}] in {where}" for where, (mean, low, high) in rows
        )
    return texts


def table(rows: Sequence[Row]) -> list[str]:
    """The defaults of a behavior and each set of options, in some recordings."""
    titles = ("fitted to", "tested on", "ADE [m]", "FDE [m]", "contacts", "recorded", "nearest [m]", "speed [m/s]")
    titles += ("distance", "ADE, goal extrapolated [m]")
    return [f"| {' | '.join(titles)} |", "|---" * len(titles) + "|", *map(_line, rows)]


def _line(row: Row) -> str:
    known, blind = row.known.likeness, row.blind.likeness
    shown = [
        heads(row.fitted_to, row.recording),
        *cells(known),
        f"{row.recorded:.1%}",
        f"{known.nearest:.3f}",
        f"{known.speed:.3f}",
        f"{distance(known, row.recorded):.3f}",
        f"{blind.ade:.2f}",
    ]
    return f"{' | '.join(shown)} |"


def heads(fitted_to: str, recording: str) -> str:
    """The first cells of a row."""
    options = f"`people: {fitted_to}`" if fitted_to in get_args(People) else fitted_to
    return f"| {options} | {f'**{recording}**' if fitted_to == recording else recording}"
