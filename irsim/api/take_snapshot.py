"""``irsim.api.snapshot``: one moment of an episode as a small picture and in words."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from irsim.api.film_strip import draw_strip, moments_of
from irsim.api.look import dress, look_options, with_look
from irsim.api.overlays import OVERLAYS, Overlay, additions, overlays_from, plan_results, plot_keys, requested_plans
from irsim.api.read_input import read_scenario
from irsim.env import Env
from irsim.episodes.episode import Progress, advance, horizon_of, seed_of
from irsim.episodes.opening import (
    MAX_TRIES,
    first_with_room,
    overlay_options,
    region_options,
    reproduce_command,
    seed_to_repeat,
    strip_options,
    unopened_findings,
)
from irsim.episodes.scene_summary import counts_of, in_words
from irsim.results.findings import Finding
from irsim.results.picture import MovingPose, RobotPose, SnapshotResult
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.resolve.resolved import ResolvedScenario, random_parts
from irsim.simulation.build import steps_until
from irsim.simulation.events import first_collisions, first_events
from irsim.simulation.outcome import explored_share, robot_outcomes
from irsim.simulation.random_streams import fresh_seed

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.policies.policy import Policy

__all__ = [
    "OVERLAYS",
    "Overlay",
    "dress",
    "ended_before",
    "extent_of",
    "moved_view",
    "snapshot",
    "snapshot_of",
    "snapshot_of_env",
]


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
    style: str | None = None,
    theme: str | None = None,
    strict: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> SnapshotResult:
    """Draw a small, labelled picture of one moment and describe it in words, without writing a file.

    Args:
        path: Scenario file.
        text: Text of the scenario, instead of ``path``.
        seed: Overrides the file's seed.
        steps: Number of steps before the picture; None: the steps of a whole episode.
        strip: Number of moments in one picture, evenly spaced from the start to ``steps`` (0: of a whole episode).
        size: Longer side of the picture [px].
        overlays: Names of the things to show besides bodies, see :data:`OVERLAYS`; default: names, goals and paths,
            and the sensors that the scenario shows.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        draw: Whether to draw the picture, too.
        style: ``modern`` or ``classic``; default: the scenario's, else :data:`irsim.api.look.DEFAULT_STYLE`.
        theme: ``light`` or ``dark``; default: the scenario's.
        strict: Refuse what IR-SIM would ignore.
        limits: Limits of the loader and of the run.
        progress: Callback ``(steps_done, steps_total)``.

    Raises:
        ScenarioError: The scenario has errors; ScenarioNotFoundError: there is no such file.
        OverLimitError: ``steps`` exceeds the limits.
        ValueError: Neither or both of ``path`` and ``text`` are given, the region is invalid, or there are too few or
            too many moments.
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
        style=style,
        theme=theme,
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
    style: str | None = None,
    theme: str | None = None,
    printed: bool = False,
    strict: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
    imports: Sequence[str] = (),
    out: str | Path = "snapshot.png",
    tries: Iterable[int] | None = None,
    policy: Policy | None = None,
    driven: str | None = None,
    base: ResolvedScenario | None = None,
    changed: Collection[str] = (),
) -> SnapshotResult:
    """Like :func:`snapshot`, for a scenario already read, with its warnings; ``path`` is only used in the result.

    A ``policy`` in Python drives the robots; ``driven`` is the text of what does, for the result. Without a seed the
    first of ``tries`` that leaves room for every object counts; by default they are drawn. Objects named in
    ``changed`` are outlined, and dashed where they are at the start of ``base`` with the same seed.
    """
    if region is not None:
        from irsim.graphics.scene.scene import region_extent

        region_extent(region)  # reports an invalid region before the simulation
    scenario = with_look(scenario, style, theme, printed=printed, as_strip=strip is not None)
    shown = None if overlays is None else overlays_from(overlays)
    chosen_seed = seed_of(scenario, seed)
    env, _ = first_with_room(
        lambda drawn: Env(scenario, seed=drawn, headless=True, log_level="ERROR", policy=policy),
        (tries or (fresh_seed() for _ in range(MAX_TRIES))) if chosen_seed is None else [chosen_seed],
    )
    if strip is not None:
        moments_of(0, strip)
        steps = steps or None
    horizon, _ = horizon_of(env.simulation, steps, limits or DEFAULT_LIMITS)
    chosen: list[int] | None = None
    if strip is None or steps is None:
        advance(env, horizon, progress, until="time_limit" if steps is not None else "done")
    if strip is not None:
        last = int(env.simulation.count[0]) if steps is None else steps
        chosen = moments_of(last, strip)
        if steps is None:  # the number of steps was unknown, so the moments are simulated again
            env.end(ending_time=0.0)
            env = Env(scenario, seed=env.seed, headless=True, log_level="ERROR", policy=policy)
    count = int(env.simulation.count[0]) if chosen is None else chosen[-1]
    if count:
        warnings = [*warnings, *unopened_findings(scenario, "a picture")]
    options = [*region_options(region), *strip_options(strip), *overlay_options(shown)]
    options += look_options(style, theme, printed)
    extra = ["--size", str(size), *options, *([] if driven is None else ["--policy", driven]), "-o", str(out)]
    repeated = seed_to_repeat(scenario, env.seed, random_parts(scenario))
    other = (
        None if base is None else Env(with_look(base, style, theme), seed=env.seed, headless=True, log_level="ERROR")
    )
    result = snapshot_of_env(
        env,
        path,
        size=size,
        overlays=shown,
        region=region,
        moments=chosen,
        draw=draw,
        printed=printed,
        warnings=warnings,
        reproduce=reproduce_command("render", path, repeated, count, strict, imports, extra=extra),
        progress=progress,
        base=other,
        changed=changed,
    )
    env.end(ending_time=0.0)
    if other is not None:
        other.end(ending_time=0.0)
    return result


def snapshot_of_env(
    env: Env,
    path: str | Path | None,
    *,
    size: int,
    overlays: Collection[Overlay] | None,
    region: Sequence[float] | None = None,
    moments: Sequence[int] | None = None,
    draw: bool,
    printed: bool = False,
    warnings: list[Finding],
    reproduce: str,
    progress: Progress | None = None,
    move: Callable[[int], None] | None = None,
    base: Env | None = None,
    changed: Collection[str] = (),
) -> SnapshotResult:
    """Like :func:`snapshot`, for an environment in its present state.

    Args:
        env: The environment.
        path: Scenario file, which is only used in the result.
        size: Longer side of the picture [px].
        overlays: Names of the things to show besides bodies.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        moments: Steps of a strip, the first of which is the present one; the environment is advanced to the last.
        draw: Whether to draw the picture, too.
        printed: Whether it has the layout for print, in the style `modern`.
        warnings: Warnings about the scenario, for the result.
        reproduce: Command that draws the same picture, for the result.
        progress: Callback ``(steps_done, steps_total)``.
        move: Moves the environment to a step of a strip; default: it is stepped.
        base: Environment of a scenario that a single picture is compared with.
        changed: Names of the objects that differ from it.
    """
    scenario = env.scenario
    png, notes = b"", list[str]()
    if moments is not None and draw:
        png = draw_strip(env, moments, size=size, overlays=overlays, region=region, progress=progress, move=move)
    elif moments is not None and move is not None:
        move(moments[-1])
    elif moments is not None:
        advance(env, moments[-1], progress, until="time_limit")
    ways = requested_plans(env, overlays)
    if moments is None and draw:
        from irsim.rendering.snapshot import render_scene

        before = None if base is None else base.simulation
        more, plot = additions(env, overlays, ways), plot_keys(overlays)
        shown: dict[str, Any] = {"extra": more, "overrides": plot, "before": before, "changed": changed}
        shown |= {"printed": printed, "notes": notes, "zones": overlays is None or "zones" in overlays}
        png = render_scene(env.simulation, size_px=size, region=region, **shown)
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
        view=None if region is not None else moved_view(env),
        ended=ended_before(env),
        explored=explored_share(env.simulation),
        robots=_poses(env),
        moving=[
            _moving(view)
            for view in env.obstacle_list
            if not view.record.static and env.simulation.appeared[view.row] >= 0
        ],
        moments=list(moments or ()),
        plans=plan_results(env, ways),
        left_out=notes,
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
        absent = bool(env.simulation.appeared[view.row] < 0)
        place = (view.init_state if absent else view.state)[:, 0]
        robots.append(
            RobotPose(
                name=view.name,
                label=view.label,
                pose=(float(place[0]), float(place[1]), float(place[2])),
                goal=None if goal is None else (float(goal[0, 0]), float(goal[1, 0])),
                status="not there yet" if absent else status.get(outcomes[view.name], "under way"),
            )
        )
    return robots


def _moving(view: ObjectView) -> MovingPose:
    vx, vy = (float(value) for value in view.velocity_xy.reshape(-1)[:2])
    pose = (float(view.state[0, 0]), float(view.state[1, 0]), float(view.state[2, 0]))
    return MovingPose(name=view.name, pose=pose, velocity=(vx, vy))


def _size_of(png: bytes) -> tuple[int, int]:
    """Width and height [px] from the header of a PNG file."""
    return int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")


def moved_view(env: Env) -> tuple[float, float, float, float] | None:
    """x_min, x_max, y_min, y_max [m] of a view that ``world.plot.viewpoint`` moves away from the world; else None.

    Args:
        env: The environment at the moment of the picture.
    """
    world = env.scenario.world
    point = world.plot.viewpoint
    if point is None:
        return None
    if isinstance(point, str):
        place = next((view.position[:, 0] for view in env.objects if view.name == point), None)
        if place is None:
            return None
        point = place.tolist()
    x, y = (float(value) for value in point[:2])
    view = (x - world.width / 2, x + world.width / 2, y - world.height / 2, y + world.height / 2)
    left, low, right, top = world.bounds
    return None if view == (left, right, low, top) else view


def extent_of(env: Env) -> tuple[float, float, float, float]:
    """x_min, x_max, y_min, y_max [m] of the world."""
    left, low, right, top = env.scenario.world.bounds
    return left, right, low, top


def ended_before(env: Env) -> int | None:
    """Step in which ``irsim run`` ends the episode, if the environment is beyond it; else None.

    It ends when every robot has arrived or been stopped, or at ``world.time_limit``.

    Args:
        env: The environment at the moment of the picture.
    """
    count, limit, ends = int(env.simulation.count[0]), env.scenario.world.time_limit, list[int]()
    outcomes = robot_outcomes(env.simulation, events=env.events)
    if outcomes and "running" not in outcomes.values():
        arrivals = first_events(env.events, "arrival")
        hits = first_collisions(env.simulation, env.events)
        ends.append(max((arrivals[name] if name in arrivals else hits[name]).step for name in outcomes))
    if limit is not None:
        ends.append(steps_until(limit, env.step_time))
    ended = min(ends, default=count)
    return ended if ended < count else None
