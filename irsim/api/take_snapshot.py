"""``irsim.api.snapshot``: one moment of an episode, as a small picture and in words."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from irsim.api.film_strip import drawn_strip, moments_of
from irsim.api.overlays import OVERLAYS, Overlay, additions, overlays_from, plan_results, planned, plot_keys
from irsim.env import Env
from irsim.episodes.episode import Progress, advance, horizon_of, read_scenario, seed_of
from irsim.episodes.reproduce import overlay_options, region_options, reproduce_command, strip_options
from irsim.episodes.scene_summary import counts_of, in_words
from irsim.results.findings import Finding
from irsim.results.picture import MovingPose, RobotPose, SnapshotResult
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.resolve.randomness import random_parts
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.outcome import robot_outcomes

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView

__all__ = ["OVERLAYS", "Overlay", "drawn", "snapshot", "snapshot_of"]


def snapshot(
    path: str | Path | None = None,
    *,
    text: str | None = None,
    seed: int | None = None,
    steps: int | None = 0,
    strip: int | None = None,
    size: int = 600,
    overlays: Iterable[str] | None = None,
    region: Sequence[float] | None = None,
    draw: bool = True,
    strict: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> SnapshotResult:
    """A small, labelled picture of one moment, and in words what is in it. Writes nothing.

    Args:
        path: Scenario file.
        text: Or its text.
        seed: Over the file's.
        steps: Steps before the picture; None: those of a whole episode.
        strip: So many moments in one picture, evenly from the start to ``steps`` (0: of a whole episode).
        size: Longer side of the picture [px].
        overlays: What to show besides bodies, see :data:`OVERLAYS`; by default names, goals and paths, and of sensors
            what the scenario says.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        draw: Make the picture too.
        strict: Refuse what IR-SIM would ignore.
        limits: Limits of the loader and of the run.
        progress: Told how far it is.

    Raises:
        ScenarioError: The scenario cannot be used; ScenarioNotFoundError: there is none.
        OverLimitError: More steps are asked for than the limits allow.
        ValueError: Neither or both of ``path`` and ``text``; a region that is none, or too few or too
            many moments.
    """
    scenario, warnings = read_scenario(path, text=text, strict=strict, limits=limits)
    return snapshot_of(
        scenario,
        path,
        warnings=warnings,
        seed=seed,
        steps=steps,
        strip=strip,
        size=size,
        overlays=overlays,
        region=region,
        draw=draw,
        strict=strict,
        limits=limits,
        progress=progress,
    )


def snapshot_of(
    scenario: ResolvedScenario,
    path: str | Path | None,
    *,
    warnings: list[Finding],
    seed: int | None = None,
    steps: int | None = 0,
    strip: int | None = None,
    size: int = 600,
    overlays: Iterable[str] | None = None,
    region: Sequence[float] | None = None,
    draw: bool = True,
    strict: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
    imports: Sequence[str] = (),
    out: str | Path = "snapshot.png",
) -> SnapshotResult:
    """The same of a scenario that has been read, with what was odd about it; ``path`` is only told."""
    if region is not None:
        from irsim.graphics.scene.scene import region_extent

        region_extent(region)  # before much work is done
    shown = None if overlays is None else overlays_from(overlays)
    env = Env(scenario, seed=seed_of(scenario, seed), headless=True, log_level="ERROR")
    if strip is not None:
        moments_of(0, strip)
        steps = steps or None
    horizon, _ = horizon_of(scenario, env, steps, limits or DEFAULT_LIMITS)
    chosen: list[int] | None = None
    if strip is None or steps is None:
        advance(env, horizon, progress, until_done=steps is None)
    if strip is not None:
        last = int(env.simulation.count[0]) if steps is None else steps
        chosen = moments_of(last, strip)
        if steps is None:  # nobody knew how long it would be
            env.end(ending_time=0.0)
            env = Env(scenario, seed=env.seed, headless=True, log_level="ERROR")
    count = int(env.simulation.count[0]) if chosen is None else chosen[-1]
    options = [*region_options(region), *strip_options(strip), *overlay_options(shown)]
    extra = ["--size", str(size), *options, "-o", str(out)]
    result = drawn(
        env,
        path,
        size=size,
        overlays=shown,
        region=region,
        moments=chosen,
        draw=draw,
        warnings=warnings,
        reproduce=reproduce_command("render", path, env, count, strict, imports, extra=extra),
        progress=progress,
    )
    env.end(ending_time=0.0)
    return result


def drawn(
    env: Env,
    path: str | Path | None,
    *,
    size: int,
    overlays: Collection[Overlay] | None,
    region: Sequence[float] | None = None,
    moments: Sequence[int] | None = None,
    draw: bool,
    warnings: list[Finding],
    reproduce: str,
    progress: Progress | None = None,
) -> SnapshotResult:
    """An environment as it is now: like :func:`snapshot`, with the command that draws the same moment.

    With ``moments``, steps of which the first is now, it is at the last of them afterwards.
    """
    scenario = env.scenario
    png = b""
    if moments is not None and draw:
        png = drawn_strip(env, moments, size=size, overlays=overlays, region=region, progress=progress)
    elif moments is not None:
        advance(env, moments[-1], progress, until_done=False)
    ways = planned(env, overlays)
    if moments is None and draw:
        from irsim.rendering.snapshot import render_scene

        extra = additions(env, overlays, ways)
        png = render_scene(env.simulation, size_px=size, region=region, overrides=plot_keys(overlays), extra=extra)
    x, y, right, top = scenario.world.bounds
    counts = counts_of(scenario)
    return SnapshotResult(
        scenario="(text)" if path is None else str(path),
        seed=env.seed,
        random=random_parts(scenario),
        steps=int(env.simulation.count[0]),
        sim_time=env.sim_time,
        extent=(x, right, y, top),
        obstacles=counts["obstacles"],
        contents=in_words(counts, robots=False, sensors=False),
        robots=_poses(env),
        moving=[_moving(view) for view in env.obstacle_list if not view.record.static],
        moments=list(moments or ()),
        plans=plan_results(env, ways),
        size=_size_of(png) if png else (0, 0),
        warnings=warnings,
        reproduce=reproduce,
        png=png,
    )


def _poses(env: Env) -> list[RobotPose]:
    outcomes = robot_outcomes(env.simulation)
    status: dict[str, Literal["under way", "arrived", "collided"]] = {"success": "arrived", "collision": "collided"}
    robots = []
    for view in env.robot_list:
        goal = None if env.scenario.is_parked(view.record) else view.goal
        robots.append(
            RobotPose(
                name=view.name,
                label=view.abbr,
                pose=(float(view.state[0, 0]), float(view.state[1, 0]), float(view.state[2, 0])),
                goal=None if goal is None else (float(goal[0, 0]), float(goal[1, 0])),
                status=status.get(outcomes[view.name], "under way"),
            )
        )
    return robots


def _moving(view: ObjectView) -> MovingPose:
    vx, vy = (float(value) for value in view.velocity_xy.reshape(-1)[:2])
    pose = (float(view.state[0, 0]), float(view.state[1, 0]), float(view.state[2, 0]))
    return MovingPose(name=view.name, pose=pose, velocity=(vx, vy))


def _size_of(png: bytes) -> tuple[int, int]:
    """Width and height, which stand at a fixed place in a PNG file."""
    return int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")
