"""The part of the page on how human behaviors are: each recorded person, foretold by a behavior."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from irsim.bridges.pedestrians.cases import read_cases
from irsim.bridges.pedestrians.comparison import CONSTANT_VELOCITY
from irsim.bridges.pedestrians.imitation import GOALS, RADIUS
from irsim.bridges.pedestrians.likeness import contacts
from irsim.bridges.pedestrians.published import SHA256
from irsim.common.hashing import file_digest
from irsim.scenario.behavior_override import parse_behavior
from tests.benchmarks.pedestrians.walks import Walks, cells, constant_velocity, walks_of

FILES = {"ETH": "eth_obsmat.txt", "hotel": "hotel_obsmat.txt", "zara01": "trajectron_zara01.txt"}
"""Name on the page -> file."""
PUBLISHED = {
    "ETH": "github.com/crowdbotp/OpenTraj, commit 97ec1d5e, `datasets/ETH/seq_eth/obsmat.txt`",
    "hotel": "the same, `datasets/ETH/seq_hotel/obsmat.txt`",
    "zara01": "github.com/StanfordASL/Trajectron-plus-plus, commit 1031c7bd, "
    "`experiments/pedestrians/raw/raw/all_data/crowds_zara01.txt`",
}
"""Name on the page -> where the file is."""
BEHAVIORS = ("dash", "orca", "{name: orca, timeHorizon: 2}", "sfm")


def files_table(data: Path) -> str:
    """The files of a folder, and whether the published results were made with them."""
    lines = ["| recording | file here | published in | SHA-256 |", "|---|---|---|---|"]
    for name, file in FILES.items():
        digest = file_digest(data / file)
        note = "" if digest == SHA256[name.lower()] else ", not the published file"
        lines.append(f"| {name} | `{file}` | {PUBLISHED[name]} | `{digest}`{note} |")
    return "\n".join(lines)


def compare(data: Path, names: Sequence[str] = tuple(FILES), behaviors: Sequence[str] = BEHAVIORS) -> list[Walks]:
    """Behaviors in the place of the people of some recordings."""
    made = []
    for name in names:
        cases = read_cases(data / FILES[name])
        made.append(constant_velocity(cases))
        made += [walks_of(cases, text, parse_behavior(text), goal) for text in behaviors for goal in GOALS]
    return made


def table(walks: Sequence[Walks], name: str) -> list[str]:
    """The table of one recording."""
    rows = [row for row in walks if row.recording == Path(FILES[name]).stem]
    lines = [
        f"**{name}**: {rows[0].likeness.cases} cases",
        "",
        "| behavior | goal | ADE [m] | FDE [m] | contacts | speed [m/s] | nearest [m] |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        one = row.likeness
        lines.append(
            f"| {named(row.behavior)} | {row.goal or '–'} | {' | '.join(cells(one))} "
            f"| {one.speed:.3f} | {one.nearest:.3f} |"
        )
    return lines


def parts(data: Path, walks: Sequence[Walks]) -> dict[str, str]:
    """The text of this part of the page.

    Args:
        data: Folder of the recordings.
        walks: The result of :func:`compare`.
    """
    ours = [_ours(walks, CONSTANT_VELOCITY, ""), *(_ours(walks, name, GOALS[1]) for name in BEHAVIORS)]
    recorded = [(name, read_cases(data / file)) for name, file in FILES.items()]
    return {
        "radius": f"{RADIUS:g}",
        "recorded": ", ".join(f"{name} {contacts(cases, cases.truth, RADIUS):.1%}" for name, cases in recorded),
        "tables": "\n\n".join("\n".join(table(walks, name)) for name in FILES),
        "ours": "\n".join(ours),
    }


def _ours(walks: Sequence[Walks], behavior: str, goal: str) -> str:
    shown = []
    for name in ("hotel", "zara01"):
        wanted = (Path(FILES[name]).stem, behavior, goal)
        row = next(row for row in walks if (row.recording, row.behavior, row.goal) == wanted)
        shown.append(f"{row.likeness.ade:.2f} / {row.likeness.fde:.2f}")
    how = f"{named(behavior)}, goal {goal}" if goal else behavior
    return f"| this page | {how} | {shown[0]} | {shown[1]} |"


def named(behavior: str) -> str:
    """A behavior as the page names it."""
    return behavior if behavior == CONSTANT_VELOCITY else f"`{behavior}`"
