"""Limits of one call: sizes, counts and times beyond which it is refused or stopped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from irsim.scenario.limits import Limits

__all__ = [
    "MAX_BEHAVIORS",
    "MAX_EPISODES",
    "MAX_RUN_SECONDS",
    "MAX_RUN_SEEDS",
    "MAX_SCENARIOS",
    "MAX_SEED",
    "MAX_SEEDS",
    "MAX_STEPS",
    "MAX_WAIT_SECONDS",
    "ServerLimits",
    "scenario_limits",
]

MAX_STEPS = 5_000
"""Number of steps of one run."""
MAX_SCENARIOS = 20
"""Number of scenarios of a benchmark."""
MAX_BEHAVIORS = 8
"""Number of behaviors of a benchmark."""
MAX_SEEDS = 100
"""Number of seeds of a benchmark."""
MAX_RUN_SEEDS = 20
"""Number of seeds of one call of run_episode; a benchmark takes more, as a job."""
MAX_EPISODES = 2_000
"""Number of episodes of a benchmark."""
MAX_SEED = 2**53 - 1
"""Largest seed; some JSON readers cannot represent larger whole numbers."""
MAX_WAIT_SECONDS = 50
"""Longest time that one call waits for a job."""
MAX_RUN_SECONDS = 45
"""Longest wall-clock time of one run; hosts commonly give up on a call after a minute."""


@dataclass(frozen=True)
class ServerLimits:
    """Limits of the server; the first group can be changed on its command line.

    Attributes:
        robots: Number of robots of a scenario.
        objects: Number of robots and obstacles of a scenario.
        work: Number of steps times objects of one run.
        workers: Number of worker processes at the same time.
        yaml_bytes: Size of a scenario [bytes].
        yaml_events: Number of values and brackets of a scenario; as many more may come from aliases.
        yaml_depth: Nesting of lists and mappings.
        yaml_aliases: Number of aliases.
        check_seconds: Wall-clock time of validating a scenario [s].
        draw_seconds: Wall-clock time of drawing a picture [s].
        memory: Address space of a worker [bytes].
        cells: Number of cells of a map.
        map_bytes: Size of a map file [bytes].
        written: Size of a file that a worker writes [bytes]; only libraries write such files, as caches.
        jobs: Number of jobs that run at the same time in a workspace.
        job_seconds: Wall-clock time of a job [s]; each of its processes may compute this long on every core.
        bridges: Whether runs may open bridges to other programs.
        text: Number of characters of text in one result, about four per token.
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
    bridges: bool = False


def scenario_limits(limits: ServerLimits, workspace: Path) -> Limits:
    """The limits of the loader and of a run, which read no files outside the workspace."""
    return Limits(
        bytes=limits.yaml_bytes,
        events=limits.yaml_events,
        expansion=limits.yaml_events,
        aliases=limits.yaml_aliases,
        depth=limits.yaml_depth,
        objects=limits.objects,
        robots=limits.robots,
        root=str(workspace),
        steps=MAX_STEPS,
        work=limits.work,
        cells=limits.cells,
        map_bytes=limits.map_bytes,
        bridges=limits.bridges,
    )
