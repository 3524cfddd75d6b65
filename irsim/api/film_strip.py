"""Film strip: several moments of an episode as one picture."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING

from irsim.api.overlays import Overlay, additions, plot_keys, requested_plans
from irsim.diagnostics.errors import InputError, PolicyLostError
from irsim.episodes.episode import Progress, advance
from irsim.results.picture import MAX_MOMENTS, MIN_MOMENTS

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["StripError", "draw_strip", "moments_of"]


class StripError(InputError):
    """A strip has an invalid number of moments."""

    where = "strip"


def moments_of(last: int, count: int) -> list[int]:
    """Steps of the moments of a strip, evenly spaced from 0 to the last one; fewer in a shorter episode.

    Raises:
        StripError: ``count`` is too small or too large for one picture.
    """
    if not MIN_MOMENTS <= count <= MAX_MOMENTS:
        what = f"a strip must have {MIN_MOMENTS} to {MAX_MOMENTS} moments, got {count}"
        raise StripError(what, f"give {MIN_MOMENTS} to {MAX_MOMENTS}")
    return sorted({round(k * last / (count - 1)) for k in range(count)})


def draw_strip(
    env: Env,
    moments: Sequence[int],
    *,
    size: int,
    overlays: Collection[Overlay] | None = None,
    region: Sequence[float] | None = None,
    progress: Progress | None = None,
    may_be_lost: bool = False,
    move: Callable[[int], None] | None = None,
) -> bytes:
    """Draw moments of an episode as one PNG, and advance the environment to the last of them.

    Args:
        env: An environment at its start.
        moments: Steps of the moments, ascending.
        size: Greatest length of the longer side of the picture [px].
        overlays: Names of the things to show besides bodies.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        progress: Callback ``(steps_done, steps_total)``.
        move: Moves the environment to a step; default: it is stepped.
        may_be_lost: Whether the strip ends early where the policy of another process is lost, instead of an error.

    Raises:
        PolicyLostError: The policy is lost.
    """
    from irsim.rendering.strip import Strip  # loads Matplotlib

    sheet = Strip(len(moments), size, region=region, overrides=plot_keys(overlays))
    for moment in moments:
        before, lost = int(env.simulation.count[0]), False
        try:
            if move is not None:
                move(moment)
            else:
                advance(env, moment - before, None, until="time_limit")
        except PolicyLostError:
            if not may_be_lost:
                raise
            lost = True
        if lost and int(env.simulation.count[0]) == before:
            break  # this moment has its picture
        sheet.add(env.simulation, additions(env, overlays, requested_plans(env, overlays)))
        if progress is not None:
            progress(moment, moments[-1])
        if lost:
            break
    return sheet.png()
