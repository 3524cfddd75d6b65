"""What one call may cost: sizes, counts and times beyond which it is refused or stopped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from irsim.scenario.limits import Limits

__all__ = [
    "BEHAVIORS",
    "EPISODES",
    "RUN_SECONDS",
    "SCENARIOS",
    "SEED",
    "SEEDS",
    "STEPS",
    "WAIT_SECONDS",
    "ServerLimits",
    "scenario_limits",
]

STEPS = 5_000
"""Steps of one run."""
SCENARIOS, BEHAVIORS, SEEDS, EPISODES = 20, 5, 100, 2_000
"""Of a benchmark."""
SEED = 2**53 - 1
"""Largest seed: beyond, not everybody who reads JSON has whole numbers."""
WAIT_SECONDS = 50
"""Longest wait for a job in one call."""
RUN_SECONDS = 45
"""Wall-clock time of one run; hosts commonly give up on a call after a minute."""


@dataclass(frozen=True)
class ServerLimits:
    """Limits of the server; those in the first group can be raised on its command line.

    Attributes:
        robots: Robots of a scenario.
        objects: Robots and obstacles of a scenario.
        work: Steps times objects of one run.
        workers: Processes at work at the same time.
        yaml_bytes: Size of a scenario.
        yaml_events: Values and brackets in it, and as many again that aliases may add.
        yaml_depth: Nesting of lists and mappings.
        yaml_aliases: Aliases.
        check_seconds: Wall-clock time of checking a scenario.
        draw_seconds: Wall-clock time of a picture.
        memory: Address space of a worker [bytes].
        cells: Cells of a map.
        map_bytes: Size of a map file.
        written: Size of a file that a worker writes, which only caches of libraries are [bytes].
        jobs: Jobs that run at the same time in a workspace.
        job_seconds: Wall-clock time of a job; each of its processes may compute as long on every core.
        text: Characters of text in one result, about four to a token.
    """

    robots: int = 1_000
    objects: int = 5_000
    work: int = 20_000_000

    workers: int = 4
    yaml_bytes: int = 256 * 1024
    yaml_events: int = 50_000
    yaml_depth: int = 32
    yaml_aliases: int = 64
    check_seconds: int = 20
    draw_seconds: int = 45
    memory: int = 2 * 1024**3
    cells: int = 16_000_000
    map_bytes: int = 32 * 1024**2
    written: int = 16 * 1024**2
    jobs: int = 2
    job_seconds: int = 3600
    text: int = 24_000


def scenario_limits(limits: ServerLimits, workspace: Path) -> Limits:
    """The same for the reader and runner of scenarios, who stays inside the workspace."""
    return Limits(
        bytes=limits.yaml_bytes,
        events=limits.yaml_events,
        expansion=limits.yaml_events,
        aliases=limits.yaml_aliases,
        depth=limits.yaml_depth,
        objects=limits.objects,
        robots=limits.robots,
        root=str(workspace),
        steps=STEPS,
        work=limits.work,
        cells=limits.cells,
        map_bytes=limits.map_bytes,
    )
