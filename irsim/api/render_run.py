"""``irsim render RUN``: draw a recorded run, with all that a policy, a program or a bridge did in it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from irsim.api.film_strip import moments_of
from irsim.api.look import look_options, with_look
from irsim.api.overlays import overlays_from
from irsim.api.render_scenario import show_part, usual_size, write_picture, write_sheet
from irsim.api.take_snapshot import snapshot_of_env
from irsim.common.files import check_suffix
from irsim.env import Env
from irsim.episodes.episode import Progress
from irsim.episodes.opening import region_options
from irsim.results.picture import RenderResult
from irsim.runs.reading import open_run
from irsim.runs.resimulation import follow_record, scenario_of, step_of
from irsim.scenario.limits import Limits
from irsim.validation.scene_table import scene_table

__all__ = ["render_run"]


def render_run(
    run: str | Path,
    out: str | Path,
    *,
    steps: int | None = None,
    size: int | None = None,
    region: Sequence[float] | None = None,
    strip: int | None = None,
    overlays: Iterable[str] | None = None,
    style: str | None = None,
    theme: str | None = None,
    printed: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> RenderResult:
    """Draw a recorded run: a picture (png, svg, pdf, jpg) of a step, a strip, or an animation (gif, mp4, apng).

    Objects are moved as recorded, whatever moved them; nothing is simulated again.

    Args:
        run: Id or folder of the run, or ``last``.
        out: File to write; its suffix determines the format.
        steps: The step of a picture (default: the last one), or the last step of an animation or a strip.
        size: As for :func:`irsim.render`, like the next three.
        region: Part to show.
        strip: Number of moments.
        overlays: Things to show besides bodies.
        style: Style, like the next two.
        theme: Colours.
        printed: Whether it is for print.
        limits: Limits of the loader.
        progress: Callback ``(steps_done, steps_total)``.

    Raises:
        RunError: There is no such run or step, or the run cannot be read.
        ScenarioError: The scenario of the run has errors.
        ValueError: The suffix is unsupported, the region is invalid, or there are too few or too many moments.
    """
    target, opened = Path(out), open_run(run)
    last = step_of(opened, steps)
    shown = None if overlays is None else overlays_from(overlays)
    if strip is not None or shown is not None:
        check_suffix(target, ["png"])
    moments = None if strip is None else moments_of(last, strip)
    scenario = with_look(scenario_of(opened, limits), style, theme, printed=printed, as_strip=strip is not None)
    env = Env(scenario, seed=int(opened.meta["seed"]), display=False, log_level="ERROR")
    move, table = follow_record(opened, env), scene_table(env.scenario, env.seed, None)
    given = ["--step", str(last), *([] if size is None else ["--size", str(size)]), *region_options(region)]
    given += [] if strip is None else ["--strip", str(strip)]
    given += look_options(style, theme, printed)
    reproduce = " ".join(["irsim render", opened.id, *given, "-o", str(out)])
    if moments is not None or shown is not None:
        if moments is None:
            move(last)
        sheet = snapshot_of_env(
            env,
            opened.meta.get("scenario"),
            size=usual_size(size, printed),
            printed=printed,
            overlays=shown,
            region=region,
            moments=moments,
            draw=True,
            warnings=[],
            reproduce=reproduce,
            progress=progress,
            move=move,
        )
        env.end(ending_time=0.0)
        return write_sheet(sheet, target, table)
    show_part(env, size, region, printed)
    return write_picture(
        env,
        target,
        last,
        region=region,
        progress=progress,
        move=move,
        scenario=str(opened.meta.get("scenario")),
        warnings=[],
        table=table,
        reproduce=reproduce,
    )
