"""Environments and batches in a notebook: a picture of the present, facts, and the replay of an episode."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irsim.common.lazy import call_home
from irsim.common.notebook import Page, facts, picture, section, table
from irsim.common.text import seconds
from irsim.env.queries import robot_list
from irsim.env.state import EnvState
from irsim.simulation.outcome import outcome_of

__all__ = ["NO_TRACKS", "batch_html", "env_html", "replay", "world_picture"]

_SIZE_PX = 480
NO_TRACKS = {"show_trajectory": False, "show_trail": False}
"""Plot keys of batches, which do not keep where objects were."""


def replay(env: EnvState, height: int = 640) -> Page:
    """The replay of the present episode, up to the present step: a page that a notebook shows below the cell.

    ``env.replay().save("replay.html")`` writes it to a file. Nothing has to be recorded for it.

    Args:
        height: Height in the notebook [px].

    Raises:
        InputError: Objects were added or deleted, or code in Python keeps something that cannot be copied.
    """
    result: Page = call_home("irsim.runs.replay.inline:replay_of_env", env, height)
    return result


def env_html(env: Any) -> str:
    """The present state as a notebook shows it: a picture, facts and a table of the robots."""
    known = {"seed": env.seed, "time": seconds(env.time), "outcome": env.outcome, "objects": len(env.names)}
    rows = [
        (one.name, one.kinematics, getattr(one.record.behavior, "name", None), *_pose(one), one.arrive, one.collision)
        for one in robot_list(env)
    ]
    robots = table(("robot", "drive", "behavior", "x [m]", "y [m]", "heading [rad]", "arrived", "collided"), rows)
    return section(
        f"Environment {env.scenario.name}", world_picture(env.simulation), facts(known), robots if rows else ""
    )


def batch_html(batch: Any) -> str:
    """The present state as a notebook shows it: a picture of the first world, facts and a table of the worlds."""
    simulation, name = batch.simulation, batch.scenario.name
    known = {"worlds": batch.n, "objects in each": len(batch.names), "worlds that are done": int(batch.done.sum())}
    steps = batch.scenario.world.step_time
    rows = [
        (world, batch.seeds[world], seconds(int(batch.count[world]) * steps), outcome_of(simulation, world))
        for world in range(batch.n)
    ]
    worlds = table(("world", "seed", "time", "outcome"), rows)
    return section(f"Batch of {name}: world 0", world_picture(simulation, NO_TRACKS), facts(known), worlds)


def world_picture(simulation: Any, keys: Mapping[str, bool] | None = None) -> str:
    """A picture of the first world as HTML.

    Args:
        simulation: The simulation.
        keys: Plot keys of all objects.
    """
    png = call_home("irsim.rendering.snapshot:render_scene", simulation, size_px=_SIZE_PX, overrides=keys)
    return f"<p>{picture(png, 'the world from above')}</p>"


def _pose(view: Any) -> tuple[float, ...]:
    return tuple(round(float(value), 3) for value in view.state[:3, 0])
