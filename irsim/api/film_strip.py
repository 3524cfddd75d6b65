"""Several moments of an episode as one picture."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from irsim.api.overlays import Overlay, additions, planned, plot_keys
from irsim.diagnostics.errors import ArgumentError

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.episodes.episode import Progress

__all__ = ["FEWEST", "MOST", "StripError", "drawn_strip", "moments_of"]

FEWEST, MOST = 2, 12
"""Moments of one picture."""


class StripError(ArgumentError):
    """No such strip can be drawn."""

    where = "strip"


def moments_of(last: int, count: int) -> list[int]:
    """So many steps, evenly from 0 to the last one; fewer if there are not so many.

    Raises:
        StripError: They are too few or too many for a picture.
    """
    if not FEWEST <= count <= MOST:
        raise StripError(f"a strip of {count} moments", f"give {FEWEST} to {MOST}")
    return sorted({round(k * last / (count - 1)) for k in range(count)})


def drawn_strip(
    env: Env,
    moments: Sequence[int],
    *,
    size: int,
    overlays: Collection[Overlay] | None = None,
    region: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> bytes:
    """Draw moments of an episode as one PNG; the environment is at the last of them afterwards.

    Args:
        env: An environment at its start.
        moments: Steps, ascending.
        size: Longer side of the picture at most [px].
        overlays: What to show besides bodies.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        progress: Told how far it is.
    """
    from irsim.episodes.episode import advance
    from irsim.rendering.strip import Strip

    sheet = Strip(len(moments), size, region=region, overrides=plot_keys(overlays))
    for moment in moments:
        advance(env, moment - int(env.simulation.count[0]), None, until_done=False)
        sheet.add(env.simulation, additions(env, overlays, planned(env, overlays)))
        if progress is not None:
            progress(moment, moments[-1])
    return sheet.png()
