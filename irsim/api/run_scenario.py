"""``irsim.run``: simulate a scenario, for the CLI, Python and MCP alike."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from irsim.api.look import DEFAULT_STYLE
from irsim.api.read_input import opened_policy, read_scenario, rules_of_suite
from irsim.api.render_scenario import animate
from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.connect import connect, open_bridges
from irsim.bridges.options import bridge_text, check_files, read_bridges
from irsim.common.extras import require
from irsim.common.keywords import answers_misspelt
from irsim.common.text import seconds
from irsim.diagnostics.errors import InputError, PolicyLostError
from irsim.env import Env
from irsim.episodes.episode import Progress, advance, horizon_of, seed_of
from irsim.episodes.opening import MAX_TRIES, crowded_message, findings_under_policy, first_with_room
from irsim.episodes.run_report import RunPlan, run_result
from irsim.episodes.suitability import unsuited
from irsim.results.findings import Finding
from irsim.results.run import Again, RunResult, Until
from irsim.runs.recorder import recording
from irsim.scenario.checks.bridges import driven_without_goal
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.open import import_modules
from irsim.scenario.perturbation import Perturbations, perturbation_text, read_perturbations
from irsim.simulation.events import read_events
from irsim.simulation.random_streams import fresh_seed

if TYPE_CHECKING:
    from irsim.bridges.connect import Connection
    from irsim.policies.catalog import PolicySource
    from irsim.scenario.resolve.resolved import ResolvedScenario
    from irsim.simulation.simulation import Simulation

__all__ = ["run"]


@answers_misspelt
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
    until: Until | None = None,
    bridges: Sequence[str | Mapping[str, Any]] = (),
    imports: Sequence[str] = (),
    save: str | Path | None = None,
    show: bool = False,
    speed: float = 1.0,
    record: bool | str | Path = False,
    export: str | Path | Sequence[str | Path] = (),
    overwrite: bool = False,
    recorded: Callable[[str], None] | None = None,
    connected: Callable[[str], None] | None = None,
    limits: Limits | None = None,
    progress: Progress | None = None,
    watched: Callable[[Simulation, int], Progress] | None = None,
) -> RunResult:
    """Simulate one episode, until every robot has arrived or stopped, or the horizon is reached.

    Without robots it ends when everything that moves has arrived or stopped, and at once where nothing moves, unless
    it is shown or connected.

    Args:
        path: Scenario file, or ``SUITE/SCENARIO``.
        text: Text of the scenario, instead of ``path``.
        seed: Overrides the file's seed. Without either, a random seed is drawn and reported (0 if nothing is random).
        steps: Horizon in steps, which overrides ``world.time_limit``.
        strict: Refuse what IR-SIM would ignore.
        policy: A policy that drives every robot instead of its own behavior, see :func:`irsim.open_policy`: the name
            of a behavior or a plug-in, with options as a mapping (in Python or as YAML text, such as ``{name: orca,
            timeHorizon: 5}``), a file (``model.npz``), a function of observations, or a policy.
        behavior: Another name of ``policy``.
        perturb: Starts, speeds and delays that differ from the scenario, as the seed draws them: see
            :func:`irsim.benchmark`. Default: the suite's, if ``path`` is of one; an empty list perturbs nothing.
        until: ``done`` ends the run when every robot has arrived or stopped; ``time_limit`` lets it go on to its
            horizon: a robot with ``loop`` patrols on after its first lap; ``first_collision`` also ends it when a
            robot collides, unless it is shown or saved. Default: as the suite of ``path`` says, else ``done``.
        bridges: Connections to other programs, which the scenario does not name: mappings such as ``{"name":
            "json_lines"}``, or their text. Each takes part in the steps.
        imports: Modules to import first, for behaviors that they register.
        save: Also write an animation to this file (gif, mp4, apng, …).
        show: Also show the episode live in a window.
        speed: How many times as fast as in reality the window shows it, as far as drawing can.
        record: Also record the run: True records to a folder below ``.irsim/runs`` of the current directory, which is
            deleted 24 hours after its last use; a path records to a new folder that is kept.
            :func:`irsim.runs.open_run` reads the recording.
        export: Files to write when the run is over, each in the format of its suffix: see :func:`irsim.export_run`.
        overwrite: Replace exported files that exist.
        recorded: Callback ``(run_id)``, called when the recording starts.
        connected: Callback ``(sentence)``, called when all bridges are connected: with what, and when the run ends.
        limits: Limits of the loader and of the run.
        progress: Callback ``(steps_done, steps_total)``.
        watched: Callback ``(simulation, greatest number of steps)``, called before the first step; the callback
            ``(steps_done, steps_total)`` that it returns is called after every step.

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
    rules = rules_of_suite(path, text)
    import_modules(imports)
    perturbations = read_perturbations(rules[0] if perturb is None else perturb)
    until = cast("Until", rules[1]) if until is None else until
    named_behavior = behavior
    driver, behavior = opened_policy(path, policy, behavior, limits)
    try:
        scenario, warnings = read_scenario(
            path, text=text, strict=strict, limits=limits, behavior=behavior, perturb=perturbations
        )
    except InputError as error:
        if error.where == "behavior" and policy is not None:
            error.where = "policy"
        raise
    if driver is not None:
        warnings = findings_under_policy(warnings, scenario)
        warnings += [Finding.of(item) for item in unsuited(driver.text or "", scenario)]
    chosen, hidden = seed_of(scenario, seed), save is None and not show
    env, crowded = first_with_room(
        lambda drawn: Env(scenario, seed=drawn, display=show, headless=hidden, log_level="ERROR", policy=driver),
        (fresh_seed() for _ in range(MAX_TRIES)) if chosen is None else [chosen],
    )
    simulation = env.simulation
    horizon, source = horizon_of(simulation, steps, limits or DEFAULT_LIMITS)
    added = read_bridges(bridges) if bridges else []
    opened = _allowed_bridges([*scenario.bridges, *added], limits) if scenario.bridges or added else []
    plan = RunPlan(
        path,
        horizon,
        source,
        warnings=[*warnings, *_goals_missing(scenario, added)],
        strict=strict,
        imports=imports,
        behavior=behavior,
        policy=driver,
        perturb=[perturbation_text(one) for one in perturbations],
        bridges=[bridge.name for bridge in opened],
        added_bridges=[bridge_text(one) for one in added],
        until=until,
    )
    targets = _check_exports([export] if isinstance(export, (str, Path)) else export, overwrite=overwrite)
    follow = None if watched is None else watched(simulation, horizon)
    with (
        _kept_or_temporary(record, targets) as kept,
        connect(env, opened) if opened else nullcontext() as connection,
        recording(simulation, path, kept, horizon=horizon, options=plan.record_options()) as recorder,
    ):
        if connection is not None and connected is not None:
            connected(_connected_sentence(connection, opened, horizon * env.step_time))
        if recorder is not None and recorded is not None and record is not False:
            recorded(recorder.run_id)
        files, lost = list[str](), None
        alone = connection is None and not show  # no program moves obstacles, and there is no window
        end = until if alone or env.robot_list else "time_limit"
        try:
            if save is None and not show:
                advance(env, horizon, progress, until=end, recorder=recorder, follow=follow)
            else:
                env._env_plot.set_style(scenario.world.plot.style or DEFAULT_STYLE)
                target, on = Path(save) if save is not None else None, end == "time_limit"
                files = animate(env, horizon, target, progress, recorder, go_on=on, speed=speed, follow=follow)
        except (PolicyLostError, BridgeLostError) as error:
            lost = error
        result = run_result(simulation, read_events(simulation), plan, files=files, lost=lost)
        if connection is not None:
            result.notes += connection.notes()
        if skipped := crowded_message(crowded):
            result.summary += f"; {skipped}"
        if recorder is not None:
            recorder.finish(result)
            exported, notes = _export_all(Path(recorder.folder), targets, overwrite=overwrite)
            result.files += exported
            result.notes += notes
            if record is False:
                result.run_id, result.artifacts = None, {}  # of a record that is deleted now
    env.end(ending_time=0.0)
    given: dict[str, Any] = {
        "path": path,
        "text": text,
        "seed": result.seed,
        "steps": steps,
        "strict": strict,
        "policy": policy,
    }
    given |= {"behavior": named_behavior, "perturb": perturb, "until": until, "imports": imports, "limits": limits}
    result._again = again = Again()
    again.arguments = given | {"bridges": plan.bridges}
    return result


def _goals_missing(scenario: ResolvedScenario, bridges: Sequence[Any]) -> list[Finding]:
    """Warnings of robots without a goal that added bridges may drive; the checker knows the bridges in the scenario."""
    return [Finding.of(one.diagnostic) for one in driven_without_goal(scenario, bridges)] if bridges else []


def _allowed_bridges(options: Sequence[Any], limits: Limits | None) -> list[Bridge]:
    """The bridges of some options, not connected yet.

    Raises:
        BridgeError: They may not be opened here.
    """
    if options and not (limits or DEFAULT_LIMITS).bridges:
        what = f"the scenario has bridges ({', '.join(str(one.name) for one in options)}), which are not opened here"
        raise BridgeError(
            "bridges-disabled", what, "leave out the key bridges, or start irsim-mcp with --enable-bridges"
        )
    if limits is not None and limits.root is not None:
        check_files(options, Path(limits.root))
    return open_bridges(options)


def _connected_sentence(connection: Connection, bridges: Sequence[Bridge], time_limit: float) -> str:
    """With what a run is connected, and when it ends: at ``time_limit`` [s] at the latest."""
    stops = " and stops the robots" if any(bridge.mode == "real" for bridge in bridges) else ""
    until = f"the run ends when all robots have arrived or stopped, or at {seconds(time_limit)}"
    return f"connected to {connection.peers()}; {until}; Ctrl-C ends it now{stops}"


def _check_exports(files: Sequence[str | Path], *, overwrite: bool) -> list[Path]:
    """The files to write after a run, checked before it.

    Raises:
        RunError: A suffix selects no format.
        TargetError: A file exists, and ``overwrite`` is not set.
        ExtraError: A library is missing.
    """
    if not files:
        return []  # as for most runs, which load no formats
    from irsim.bridges.export.export import check_target
    from irsim.bridges.export.registry import find_format

    targets = [Path(file) for file in files]
    for target in targets:
        form = find_format(None, target)
        require(form.extra, *form.libraries)
        check_target(form, target, overwrite=overwrite)
    return targets


@contextmanager
def _kept_or_temporary(record: bool | str | Path, exports: Sequence[Path]) -> Iterator[bool | str | Path]:
    """Where to record a run: where the caller wants it, else in a temporary folder if files are made of it."""
    if record is not False or not exports:
        yield record
        return
    folder = Path(tempfile.mkdtemp(prefix="irsim-"))
    try:
        yield folder / "run"
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _export_all(run: Path, targets: Sequence[Path], *, overwrite: bool) -> tuple[list[str], list[str]]:
    """Write the files; return their paths, and notes on what they leave out."""
    from irsim.bridges.export.export import export_run

    written = [export_run(run, target, overwrite=overwrite) for target in targets]
    return [one.file for one in written], [note for one in written for note in one.notes]
