"""``irsim.run`` and ``irsim.render``: simulate or draw a scenario, for the CLI, Python and MCP alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.api.export_after import check_exports, export_all, kept_or_temporary
from irsim.api.open_connections import allowed_bridges, connected_sentence
from irsim.api.picture_notes import ended_before, extent_of, moved_view
from irsim.api.read_input import policy_of_suite, read_scenario
from irsim.api.take_snapshot import snapshot, snapshot_of
from irsim.bridges.base import BridgeLostError
from irsim.bridges.connect import connect
from irsim.bridges.options import bridge_text, read_bridges
from irsim.common.arguments import check_whole_number
from irsim.common.files import check_suffix
from irsim.diagnostics.errors import InputError, PolicyLostError
from irsim.env import Env
from irsim.episodes.episode import Progress, advance, default_time_limit, horizon_of, seed_of
from irsim.episodes.opening import (
    MAX_TRIES,
    crowded_message,
    findings_under_policy,
    first_with_room,
    unopened_findings,
)
from irsim.episodes.reproduce import region_options, reproduce_command, seed_to_repeat
from irsim.episodes.run_report import RunPlan, run_result
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import open_policy
from irsim.results.findings import Finding
from irsim.results.picture import RenderResult, SnapshotResult
from irsim.results.run import RunResult
from irsim.runs.recorder import Recorder, recording
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.checks.bridges import driven_without_goal
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.open import import_modules
from irsim.scenario.perturbation import Perturbations, perturbation_text, perturbed, read_perturbations
from irsim.simulation.events import read_events
from irsim.simulation.random_streams import fresh_seed
from irsim.validation.scene_table import scene_table
from irsim.validation.validate import diff, fix, validate

if TYPE_CHECKING:
    from irsim.policies.catalog import PolicySource
    from irsim.policies.policy import Policy
    from irsim.results.picture import SceneTable

__all__ = [
    "default_time_limit",
    "diff",
    "fix",
    "import_modules",
    "read_scenario",
    "render",
    "run",
    "snapshot",
    "validate",
]


def run(
    path: str | Path | None = None,
    *,
    text: str | None = None,
    seed: int | None = None,
    steps: int | None = None,
    strict: bool = False,
    policy: PolicySource | None = None,
    behavior: str | Mapping[str, Any] | None = None,
    perturb: Perturbations | None = None,
    bridges: Sequence[str | Mapping[str, Any]] = (),
    imports: Sequence[str] = (),
    save: str | Path | None = None,
    show: bool = False,
    record: bool | str | Path = False,
    export: str | Path | Sequence[str | Path] = (),
    overwrite: bool = False,
    recorded: Callable[[str], None] | None = None,
    connected: Callable[[str], None] | None = None,
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> RunResult:
    """Simulate one episode, until every robot has arrived or stopped, or the horizon is reached.

    Args:
        path: Scenario file, or ``SUITE/SCENARIO``.
        text: Text of the scenario, instead of ``path``.
        seed: Overrides the file's seed. Without either, a random seed is drawn and reported (0 if nothing is random).
        steps: Horizon in steps, which overrides ``world.time_limit``.
        strict: Refuse what IR-SIM would ignore.
        policy: What drives every robot instead of its own behavior, see :func:`irsim.open_policy`: the name of a
            behavior or a plug-in, with options as a mapping (in Python or as YAML text, such as ``{name: orca,
            timeHorizon: 5}``), a file (``model.npz``), a function of observations, or a policy.
        behavior: Another name of ``policy``.
        perturb: Starts, speeds and delays that differ from the scenario, as the seed draws them: see
            :func:`irsim.benchmark`.
        bridges: Connections to other programs, besides those of the scenario: mappings such as ``{"name":
            "json_lines"}``, or their text. Each takes part in the steps.
        imports: Modules to import first, for behaviors that they register.
        save: Also write an animation to this file (gif, mp4, apng, …).
        show: Also show the episode live in a window.
        record: Also record the run: True records to a folder below ``.irsim/runs`` of the current directory, which is
            deleted 24 hours after its last use; a path records to a new folder that is kept.
            :func:`irsim.runs.open_run` reads the recording.
        export: Files to write when the run is over, each in the format of its suffix: see :func:`irsim.export_run`.
        overwrite: Replace exported files that exist.
        recorded: Callback ``(run_id)``, called when the recording starts.
        connected: Callback ``(sentence)``, called when all bridges are connected: with what, and when the run ends.
        limits: Limits of the loader and of the run.
        progress: Callback ``(steps_done, steps_total)``.

    Raises:
        ScenarioError: The scenario has errors; ScenarioNotFoundError: there is no such file.
        OverLimitError: ``steps`` exceeds the limits.
        PlacementError: There is no room for an object that is placed at random or perturbed; without a seed, with
            none of 20 drawn ones.
        InputError: There is no such policy, ``perturb`` is not a valid perturbation, ``steps`` is not a whole number,
            or both ``policy`` and ``behavior`` are given.
        PolicyError: The policy cannot drive these robots, or failed. One in another process that is lost ends the run
            with that reason instead.
        BridgeError: A bridge is not valid, or failed, or may not be opened; a program that is lost during the run ends
            the run with that reason instead.
        RunError: The folder to record to is not empty.
        TargetError: A file to export exists, and ``overwrite`` is not set.
        ValueError: Neither or both of ``path`` and ``text`` are given.
    """
    import_modules(imports)
    driver, behavior = _opened(path, policy, behavior, limits)
    perturbations = read_perturbations(perturb)
    try:
        scenario, warnings = read_scenario(path, text=text, strict=strict, limits=limits, behavior=behavior)
    except InputError as error:
        if error.where == "behavior" and policy is not None:
            error.where = "policy"
        raise
    if driver is not None:
        warnings = findings_under_policy(warnings, scenario)
    scenario = perturbed(scenario, perturbations)
    chosen, hidden = seed_of(scenario, seed), save is None and not show
    env, crowded = first_with_room(
        lambda drawn: Env(scenario, seed=drawn, display=show, headless=hidden, log_level="ERROR", policy=driver),
        (fresh_seed() for _ in range(MAX_TRIES)) if chosen is None else [chosen],
    )
    horizon, source = horizon_of(scenario, env, steps, limits or DEFAULT_LIMITS)
    added = read_bridges(bridges)
    opened = allowed_bridges([*scenario.bridges, *added], limits)
    plan = RunPlan(
        path,
        horizon,
        source,
        warnings=[*warnings, *(Finding.of(one.diagnostic) for one in driven_without_goal(scenario, added))],
        strict=strict,
        imports=imports,
        behavior=behavior,
        policy=driver,
        perturb=[perturbation_text(one) for one in perturbations],
        bridges=[bridge.name for bridge in opened],
        added_bridges=[bridge_text(one) for one in added],
    )
    targets = check_exports([export] if isinstance(export, (str, Path)) else export, overwrite=overwrite)
    simulation = env.simulation
    with (
        kept_or_temporary(record, targets) as kept,
        connect(env, opened) if opened else nullcontext() as connection,
        recording(simulation, path, kept, horizon=horizon, options=plan.record_options()) as recorder,
    ):
        if connection is not None and connected is not None:
            connected(connected_sentence(connection, opened, horizon * env.step_time))
        if recorder is not None and recorded is not None and record is not False:
            recorded(recorder.run_id)
        files, lost = list[str](), None
        try:
            if save is None and not show:
                advance(env, horizon, progress, recorder=recorder)
            else:
                files = _animate(env, horizon, Path(save) if save is not None else None, progress, recorder)
        except (PolicyLostError, BridgeLostError) as error:
            lost = error
        result = run_result(simulation, read_events(simulation), plan, files=files, lost=lost)
        if connection is not None:
            result.notes += connection.notes()
        if skipped := crowded_message(crowded):
            result.summary += f"; {skipped}"
        if recorder is not None:
            recorder.finish(result)
            exported, notes = export_all(Path(recorder.folder), targets, overwrite=overwrite)
            result.files += exported
            result.notes += notes
            if record is False:
                result.run_id, result.artifacts = None, {}  # of a record that is deleted now
    env.end(ending_time=0.0)
    return result


def _opened(
    path: str | Path | None, policy: Any, behavior: Any, limits: Limits | None
) -> tuple[Policy | None, str | None]:
    """What drives the robots: a policy in Python, or the text of a behavior that runs in the engine, or neither.

    Raises:
        InputError: There is no such policy, or both names of the argument are used.
    """
    if policy is not None and behavior is not None:
        raise InputError("policy and behavior are two names of one argument", "give only policy")
    given, where = (behavior, "behavior") if policy is None else (policy, "policy")
    if given is None:
        return None, None
    try:
        opened = open_policy(policy_of_suite(path, given), root=None if limits is None else limits.root)
    except InputError as error:
        error.where = where
        raise
    if isinstance(opened, BehaviorPolicy):
        return None, None if opened.text == AS_WRITTEN else opened.text
    return opened, None


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
    strict: bool = False,
    imports: Sequence[str] = (),
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> RenderResult:
    """Draw a scenario: a picture (png, svg, pdf, jpg) after ``steps``, or an animation (gif, mp4, apng) of an episode.

    Args:
        path: Scenario file.
        out: File to write; its suffix determines the format.
        policy: What drives every robot, see :func:`irsim.open_policy`; default: the behaviors of the scenario.
        seed: Overrides the file's seed.
        steps: Number of steps before the picture (default 0: the start), or greatest number of steps of an animation.
        size: Longer side of the picture [px]; default from ``world.plot``.
        region: x_min, y_min, x_max, y_max [m] of the part to show; default: the world.
        strip: Number of moments on one sheet (png), labelled like snapshots, evenly spaced from the start to ``steps``
            (default: of a whole episode).
        overlays: What to show besides bodies, in a picture (png) labelled like snapshots: see
            :data:`irsim.api.overlays.OVERLAYS`.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules to import first.
        limits: Limits of the loader.
        progress: Callback ``(steps_done, steps_total)``.

    Raises:
        ScenarioError: The scenario has errors.
        InputError: There is no such policy.
        PolicyError: The policy cannot drive these robots, or failed.
        ValueError: The suffix is unsupported, the region is invalid, or there are too few or too many moments.
    """
    target = Path(out)
    steps = None if steps is None else check_whole_number("steps", steps)
    import_modules(imports)
    as_snapshot = strip is not None or overlays is not None
    if as_snapshot:
        check_suffix(target, ["png"])
    driver, behavior = _opened(path, policy, None, limits)
    scenario, warnings = read_scenario(path, strict=strict, limits=limits, behavior=behavior)
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
            size=600 if size is None else size,
            region=region,
            strict=strict,
            limits=limits,
            progress=progress,
            imports=imports,
            out=out,
            policy=driver,
            driven=driven,
        )
        return _write_sheet(sheet, target, scene_table(scenario, sheet.seed, driven if driver is not None else None))
    env = Env(scenario, seed=seed_of(scenario, seed), display=False, log_level="ERROR", policy=driver)
    if region is not None:
        env._env_plot.set_region(region)
    if size is not None:
        env._env_plot.set_size(size)
    if animated:
        horizon, _ = horizon_of(scenario, env, steps, limits or DEFAULT_LIMITS)
        files = _animate(env, horizon, target, progress)
        frames = env._env_plot.frames_written
    else:
        advance(env, steps or 0, progress, until_done=False)
        files, frames = [str(env.save_figure(target.absolute()))], 1
    sized = [*([] if size is None else ["--size", str(size)]), *region_options(region)]
    sized += [] if driven is None else ["--policy", driven]
    result = RenderResult(
        scenario=str(path),
        seed=env.seed,
        steps=int(env.simulation.count[0]),
        frames=frames,
        size=env._env_plot.size,
        files=files,
        warnings=warnings,
        ended=None if animated else ended_before(env),
        view=None if region is not None else moved_view(env),
        extent=extent_of(env),
        table=scene_table(scenario, env.seed, driven if driver is not None else None),
        reproduce=reproduce_command(
            "render", path, seed_to_repeat(scenario, env.seed), steps, strict, imports, extra=[*sized, "-o", str(out)]
        ),
    )
    env.end(ending_time=0.0)
    return result


def _write_sheet(sheet: SnapshotResult, target: Path, table: SceneTable) -> RenderResult:
    """Write a picture of several moments."""
    from irsim.common.files import replacing

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


def _animate(
    env: Env, steps: int, save: Path | None, progress: Progress | None, recorder: Recorder | None = None
) -> list[str]:
    env.save_ani = save is not None
    if save is not None:
        env.ani_kwargs["suffix"] = save.suffix  # determines how many colours a frame keeps
    env.render()
    for step in range(steps):
        if env.done():
            break
        env.step()
        if recorder is not None:
            recorder.write_if_due()
        env.render(env.step_time)
        if progress is not None:
            progress(step + 1, steps)
    if save is None:
        return []
    env.save_ani = False
    return [str(env._env_plot.save_animation(path=save))]
