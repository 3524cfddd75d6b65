"""``usd``: a stage of OpenUSD in which robots and pedestrians move, for Isaac Sim, Omniverse and Blender.

``.usda`` is text, ``.usdc`` binary and ``.usdz`` a package. :mod:`irsim.bridges.usd.stage` describes the content of
the stage; one time code is one step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.state import WorldState

__all__ = ["FORMAT"]


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the scene of a run, and where its objects were."""
    from irsim.bridges.usd.files import make_stage, save_stage

    [episode] = episodes
    scene = recorded_scene(episode.run, episode.limits)
    stage = make_stage(scene, _states(episode), moving=[actor.name for actor in episode.actors])
    save_stage(stage, target)
    return []


def _states(episode: ExportedEpisode) -> Iterator[WorldState]:
    for state in recorded_states(episode.run, limits=episode.limits):
        yield state
        episode.progress(1)


FORMAT = Format(
    "usd", ".usda", _write, libraries=("pxr",), ranges=False, extra="usd", more_suffixes=(".usdc", ".usdz"), scene=True
)
