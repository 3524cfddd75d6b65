"""The part of the page on how human behaviors are: each recorded person, foretold by a behavior."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from irsim.bridges.pedestrians.comparison import Compared, compare_pedestrians
from irsim.bridges.pedestrians.imitation import GOALS, GoalName
from irsim.bridges.pedestrians.published import SHA256
from irsim.common.hashing import file_digest

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


def compare(data: Path, names: Sequence[str] = tuple(FILES), behaviors: Sequence[str] = BEHAVIORS) -> Compared:
    """Behaviors beside the people of some recordings."""
    return compare_pedestrians([data / FILES[name] for name in names], behaviors)


def table(compared: Compared, name: str) -> list[str]:
    """The table of one recording."""
    stem = Path(FILES[name]).stem
    rows = [row for row in compared.rows if row.recording == stem]
    lines = [
        f"**{name}**: {rows[0].likeness.cases} cases",
        "",
        "| behavior | goal | ADE [m] | FDE [m] | contacts | speed [m/s] | nearest [m] |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        one = row.likeness
        lines.append(
            f"| {_name(row.behavior)} | {row.goal or '–'} | {one.ade:.2f} | {one.fde:.2f} | {one.contacts:.1%} "
            f"| {one.speed:.3f} | {one.nearest:.3f} |"
        )
    return lines


def parts(compared: Compared) -> dict[str, str]:
    """The text of this part of the page."""
    ours = [_ours(compared, "constant velocity", ""), *(_ours(compared, name, GOALS[1]) for name in BEHAVIORS)]
    return {
        "radius": f"{compared.radius:g}",
        "recorded": ", ".join(f"{name} {compared.contacts[Path(file).stem]:.1%}" for name, file in FILES.items()),
        "tables": "\n\n".join("\n".join(table(compared, name)) for name in FILES),
        "ours": "\n".join(ours),
    }


def _ours(compared: Compared, behavior: str, goal: GoalName | str) -> str:
    cells = []
    for name in ("hotel", "zara01"):
        row = next(
            row
            for row in compared.rows
            if (row.recording, row.behavior, row.goal) == (Path(FILES[name]).stem, behavior, goal)
        )
        cells.append(f"{row.likeness.ade:.2f} / {row.likeness.fde:.2f}")
    how = f"{_name(behavior)}, goal {goal}" if goal else behavior
    return f"| this page | {how} | {cells[0]} | {cells[1]} |"


def _name(behavior: str) -> str:
    return behavior if behavior == "constant velocity" else f"`{behavior}`"
