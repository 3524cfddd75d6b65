"""``irsim.render``: draw a scenario as a picture or an animation, for the CLI, Python and MCP alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.api.look import look_options, with_look
from irsim.api.read_input import opened_policy, read_scenario
from irsim.api.take_snapshot import ended_before, extent_of, moved_view, snapshot_of
from irsim.common.arguments import check_whole_number
from irsim.common.files import TargetError, check_suffix, replacing
from irsim.common.keywords import answers_misspelt
from irsim.env import Env
from irsim.episodes.episode import Progress, advance, horizon_of, seed_of
from irsim.episodes.opening import (
    findings_under_policy,
    region_options,
    reproduce_command,
    seed_to_repeat,
    unopened_findings,
)
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES
from irsim.results.picture import RenderResult, SnapshotResult
from irsim.runs.recorder import Recorder
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import image_places
from irsim.scenario.open import import_modules
from irsim.scenario.resolve.resolved import ResolvedScenario, random_parts
from irsim.simulation.outcome import is_over
from irsim.validation.scene_table import scene_table

if TYPE_CHECKING:
    from irsim.policies.catalog import PolicySource
    from irsim.results.picture import SceneTable

__all__ = ["animate", "render", "show_part", "usual_size", "write_picture", "write_sheet"]

_SIZE_PX, _PRINT_PX = 600, 944
"""Longer sides of pictures that are labelled like snapshots, on screens and for print [px]."""


@answers_misspelt
def render(
    path: str | Path,
    out: str | Path,
    *,
    policy: PolicySource | None = None,
    seed: int | None = None,
    steps: int | None = None,
    size: int | None = None,
    region: Sequence[float] | None = None,
    strip: int | None = None,
    overlays: Iterable[str] | None = None,
    style: str | None = None,
    theme: str | None = None,
    printed: bool = False,
    strict: bool = False,
    imports: Sequence[str] = (),
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> RenderResult:
    """Draw a scenario: a picture (png, svg, pdf, jpg) after ``steps``, or an animation (gif, mp4, apng) of an episode.

    Args:
        path: Scenario file.
        out: File to write; its suffix determines the format.
        policy: A policy that drives every robot, see :func:`irsim.open_policy`; default: the behaviors of the scenario.
        seed: Overrides the file's seed.
        steps: Number of steps before the picture (default 0: the start), or greatest number of steps of an animation.
        size: Longer side of the picture [px]; default from ``world.plot``.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        strip: Number of moments on one sheet (png), labelled like snapshots, evenly spaced from the start to ``steps``
            (default: of a whole episode).
        overlays: Names of the things to show besides bodies, in a picture (png) labelled like snapshots: see
            :data:`irsim.api.overlays.OVERLAYS`.
        style: ``modern`` or ``classic``; default: the scenario's, else :data:`irsim.api.look.DEFAULT_STYLE`.
        theme: ``light`` or ``dark``, of the style `modern`; default: the scenario's.
        printed: Draw for print: 8 cm wide at 300 dpi, unless ``size`` says otherwise, in the style `modern`.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules to import first.
        limits: Limits of the loader.
        progress: Callback ``(steps_done, steps_total)``.

    Raises:
        ScenarioError: The scenario has errors.
        InputError: There is no such policy.
        PolicyError: The policy cannot drive these robots, or failed.
        TargetError: The scenario reads the file.
        ValueError: The suffix is unsupported, the region is invalid, or there are too few or too many moments.
    """
    target = Path(out)
    steps = None if steps is None else check_whole_number("steps", steps)
    import_modules(imports)
    as_snapshot = strip is not None or overlays is not None
    if as_snapshot:
        check_suffix(target, ["png"])
    driver, behavior = opened_policy(path, policy, None, limits)
    scenario, warnings = read_scenario(path, strict=strict, limits=limits, behavior=behavior)
    _check_not_read(target, scenario)
    if driver is not None:
        warnings = findings_under_policy(warnings, scenario)
    animated = target.suffix.lower() in MOVING_SUFFIXES
    if not as_snapshot and (steps or animated):
        warnings = [*warnings, *unopened_findings(scenario, "a picture")]
    driven = driver.text or driver.name if driver is not None else behavior
    if as_snapshot:
        sheet = snapshot_of(
            scenario,
            path,
            warnings=warnings,
            seed=seed,
            steps=steps or 0 if strip is None else steps,
            strip=strip,
            overlays=overlays,
            size=usual_size(size, printed),
            region=region,
            style=style,
            theme=theme,
            printed=printed,
            strict=strict,
            limits=limits,
            progress=progress,
            imports=imports,
            out=out,
            policy=driver,
            driven=driven,
        )
        return write_sheet(sheet, target, scene_table(scenario, sheet.seed, driven if driver is not None else None))
    scenario = with_look(scenario, style, theme, printed=printed)
    env = Env(scenario, seed=seed_of(scenario, seed), display=False, log_level="ERROR", policy=driver)
    show_part(env, size, region, printed)
    horizon, _ = horizon_of(env.simulation, steps if animated else steps or 0, limits or DEFAULT_LIMITS)
    sized = [*([] if size is None else ["--size", str(size)]), *region_options(region)]
    sized += look_options(style, theme, printed)
    sized += [] if driven is None else ["--policy", driven]
    repeated = seed_to_repeat(scenario, env.seed, random_parts(scenario))
    return write_picture(
        env,
        target,
        horizon,
        region=region,
        progress=progress,
        scenario=str(path),
        warnings=warnings,
        table=scene_table(scenario, env.seed, driven if driver is not None else None),
        reproduce=reproduce_command("render", path, repeated, steps, strict, imports, extra=[*sized, "-o", str(out)]),
    )


def _check_not_read(target: Path, scenario: ResolvedScenario) -> None:
    """Refuse to draw over a file that the scenario reads: its map, or an image of an object."""
    folder = Path(scenario.source).parent if scenario.source is not None else None
    images = [record.description for record in scenario.objects if record.description]
    read = [Path(path) for path in scenario.map_files.values()]
    read += [place for name in images for place in image_places(name, folder)]
    if target.exists() and any(place.exists() and place.samefile(target) for place in read):
        raise TargetError("file-exists", f"the scenario reads {str(target)!r}", "name another file with -o")


def usual_size(size: int | None, printed: bool) -> int:
    """Longer side of a picture that is labelled like snapshots [px]."""
    return size or (_PRINT_PX if printed else _SIZE_PX)


def show_part(env: Env, size: int | None, region: Sequence[float] | None, printed: bool = False) -> None:
    """Set the size of a picture [px], the part that it shows, and whether it is for print.

    Where size or region are None, the scenario says them.
    """
    if printed:
        env._env_plot.set_style("modern", None, printed=True)
    if region is not None:
        env._env_plot.set_region(region)
    if size is not None:
        env._env_plot.set_size(size)


def write_picture(
    env: Env,
    target: Path,
    steps: int,
    *,
    region: Sequence[float] | None,
    progress: Progress | None,
    move: Callable[[int], None] | None = None,
    **facts: Any,
) -> RenderResult:
    """Write an animation of an environment, or a picture of it after some steps, and end it.

    Args:
        env: The environment.
        target: File to write; its suffix determines the format.
        steps: The last step.
        region: The part that was asked for.
        progress: Callback ``(steps_done, steps_total)``.
        move: Moves the environment to a step, in place of a simulation.
        facts: Other fields of the result.
    """
    animated = target.suffix.lower() in MOVING_SUFFIXES
    if animated:
        files = animate(env, steps, target, progress, move=move)
    else:
        if move is not None:
            move(steps)
        else:
            advance(env, steps, progress, until="time_limit")
        files = [str(env.save_figure(target.absolute()))]
    result = RenderResult(
        seed=env.seed,
        steps=steps if move is not None else int(env.simulation.count[0]),
        frames=env._env_plot.frames_written if animated else 1,
        size=env._env_plot.size,
        files=files,
        ended=None if animated else ended_before(env),
        view=moved_view(env) if region is None else None,
        extent=extent_of(env),
        **facts,
    )
    env.end(ending_time=0.0)
    return result


def write_sheet(sheet: SnapshotResult, target: Path, table: SceneTable) -> RenderResult:
    """Write a picture of several moments."""
    with replacing(target) as temporary:
        temporary.write_bytes(sheet.png)
    return RenderResult(
        scenario=sheet.scenario,
        seed=sheet.seed,
        steps=sheet.steps,
        frames=len(sheet.moments),
        size=sheet.size,
        files=[str(target.absolute())],
        warnings=sheet.warnings,
        ended=sheet.ended,
        view=sheet.view,
        extent=sheet.extent,
        table=table,
        labels={robot.name: robot.label for robot in sheet.robots if robot.label != robot.name},
        reproduce=sheet.reproduce,
    )


def animate(
    env: Env,
    steps: int,
    save: Path | None,
    progress: Progress | None,
    recorder: Recorder | None = None,
    move: Callable[[int], None] | None = None,
    go_on: bool = False,
    speed: float = 1.0,
    follow: Progress | None = None,
) -> list[str]:
    """Run and show an environment, and write an animation of it; return the file that was written, if any.

    ``move`` moves it to a step instead, as a recorded run does, which goes on to the last step whatever happens.
    ``go_on``: go on when every robot has arrived or stopped. ``speed``: how many times as fast as in reality a window
    shows it. ``follow`` is called after every step, like ``progress``.
    """
    env.save_ani = save is not None
    if save is not None:
        env.ani_kwargs["suffix"] = save.suffix  # determines how many colours a frame keeps
    env.render()
    for step in range(steps):
        if move is not None:
            move(step + 1)
        elif not go_on and is_over(env.simulation):
            if progress is not None and step:
                progress(step, step)  # it is over: the count ends at its total
            break
        else:
            env.step()
        if recorder is not None:
            recorder.write_if_due()
        env.render(env.step_time / speed)
        for report in (follow, progress):
            if report is not None:
                report(step + 1, steps)
    if save is None:
        return []
    env.save_ani = False
    env._env_plot.add_last_frame()
    return [str(env._env_plot.save_animation(path=save))]
