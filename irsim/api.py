"""``irsim.validate``, ``irsim.run`` and ``irsim.render``: what the CLI, Python and MCP share."""

from __future__ import annotations

import importlib
import itertools
import math
import shlex
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from irsim.diagnostics import Diagnostic, format_path
from irsim.env import Env
from irsim.observers.events import Event, first_events
from irsim.observers.outcome import robot_outcomes
from irsim.results import EventRecord, Finding, RenderResult, RobotResult, RunResult, ValidationReport
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.load import Document, load_text
from irsim.scenario.locate import locate
from irsim.scenario.objects import ResolvedScenario
from irsim.scenario.opening import open_scenario
from irsim.scenario.read import read

__all__ = ["default_time_limit", "import_modules", "read_scenario", "render", "run", "validate"]

Progress = Callable[[int, int], None]
"""Told (steps done, steps at most) now and then."""

_MIN_HORIZON = 30.0
_HORIZON_FACTOR = 4.0
_MAX_EVENTS = 100
_CHUNK_STEPS = 50
VIDEO_SUFFIXES = (".gif", ".mp4", ".apng", ".webm", ".avi", ".mov", ".mkv")


def validate(
    path: str | Path | None = None, *, text: str | None = None, strict: bool = True, limits: Limits | None = None
) -> ValidationReport:
    """Check a scenario without running it.

    Args:
        path: The file.
        text: Or its text.
        strict: What IR-SIM would ignore is an error (default) or a warning.
        limits: Tighter or wider limits of the loader.

    Raises:
        ScenarioNotFoundError: No such file.
        ValueError: Neither or both of ``path`` and ``text``.
    """
    reading = read(_source(path, text, limits), strict=strict, limits=limits or DEFAULT_LIMITS)
    findings = [_finding(d) for d in reading.diagnostics]
    count = {s: sum(f.severity == s for f in findings) for s in ("error", "warning", "hint")}
    scenario, counts = reading.scenario, dict[str, int]()
    if scenario is not None:
        robots = len(scenario.robots())
        counts = {
            "robots": robots,
            "obstacles": len(scenario.objects) - robots,
            "sensors": sum(len(o.sensors) for o in scenario.objects),
        }
        summary = "valid: " + ", ".join(f"{n} {word if n != 1 else word[:-1]}" for word, n in counts.items())
        if count["warning"]:
            summary += f"; {count['warning']} warning{'s' * (count['warning'] != 1)}"
    else:
        summary = f"{count['error']} error{'s' * (count['error'] != 1)}, {count['warning']} warnings"
    return ValidationReport(
        file=str(path) if path is not None else "(text)",
        valid=count["error"] == 0,
        summary=summary,
        errors=count["error"],
        warnings=count["warning"],
        hints=count["hint"],
        findings=findings,
        counts=counts,
    )


def run(
    path: str | Path,
    *,
    seed: int | None = None,
    steps: int | None = None,
    strict: bool = False,
    imports: Sequence[str] = (),
    save: str | Path | None = None,
    show: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> RunResult:
    """Simulate one episode, until every robot has arrived or stopped, or the horizon is reached.

    Args:
        path: Scenario file.
        seed: Over the file's; with neither, fresh entropy (reported).
        steps: Horizon in steps, over ``world.time_limit``.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules to import first, for behaviors they register.
        save: Also write an animation here (gif, mp4, apng, …).
        show: Also show it live in a window.
        limits: Limits of the loader.
        progress: Told how far it is.

    Raises:
        ScenarioError: The file cannot be used; ScenarioNotFoundError: there is none.
    """
    import_modules(imports)
    scenario, warnings = read_scenario(path, strict=strict, limits=limits)
    env = Env(scenario, seed=seed, display=show, headless=save is None and not show, log_level="ERROR")
    horizon, source = _horizon(scenario, env, steps)
    if save is None and not show:
        _advance(env, horizon, progress)
        files: list[str] = []
    else:
        files = _animate(env, horizon, Path(save) if save is not None else None, progress)
    result = _run_result(env, str(path), horizon, source, warnings, files, imports, strict)
    env.end(ending_time=0.0)
    return result


def render(
    path: str | Path,
    out: str | Path,
    *,
    seed: int | None = None,
    steps: int | None = None,
    size: int | None = None,
    strict: bool = False,
    imports: Sequence[str] = (),
    limits: Limits | None = None,
    progress: Progress | None = None,
) -> RenderResult:
    """Draw a scenario: a picture (png, svg, pdf, jpg) after ``steps``, or an animation (gif, mp4, apng) of an episode.

    Args:
        path: Scenario file.
        out: File to write; its suffix says what.
        seed: Over the file's.
        steps: Steps before the picture (default 0: the start), or the longest an animation goes on.
        size: Longer side of the picture [px]; default from ``world.plot``.
        strict: Refuse what IR-SIM would ignore.
        imports: Modules to import first.
        limits: Limits of the loader.
        progress: Told how far it is.

    Raises:
        ScenarioError: The file cannot be used; ValueError: a suffix that nothing writes.
    """
    target = Path(out)
    import_modules(imports)
    scenario, warnings = read_scenario(path, strict=strict, limits=limits)
    animated = target.suffix.lower() in VIDEO_SUFFIXES
    env = Env(scenario, seed=seed, display=False, log_level="ERROR")
    if size is not None:
        env._env_plot.set_size(size)
    if animated:
        horizon, _ = _horizon(scenario, env, steps)
        files = _animate(env, horizon, target, progress)
        frames = env._env_plot.frames_written
    else:
        _advance(env, steps or 0, progress, until_done=False)
        files, frames = [str(env.save_figure(target.absolute()))], 1
    sized = [] if size is None else ["--size", str(size)]
    result = RenderResult(
        scenario=str(path),
        seed=env.seed,
        steps=int(env.simulation.count[0]),
        frames=frames,
        size=env._env_plot.size,
        files=files,
        warnings=warnings,
        reproduce=_command("render", path, env.seed, steps, strict, imports, extra=[*sized, "-o", str(out)]),
    )
    env.end(ending_time=0.0)
    return result


def import_modules(names: Iterable[str]) -> None:
    """Import user modules (from the current directory too), for what they register.

    Raises:
        ImportError: With the module's name.
    """
    for name in names:
        if "" not in sys.path and str(Path.cwd()) not in sys.path:
            sys.path.insert(0, str(Path.cwd()))
        importlib.import_module(name.removesuffix(".py").replace("/", "."))


def read_scenario(
    path: str | Path, *, strict: bool, limits: Limits | None = None
) -> tuple[ResolvedScenario, list[Finding]]:
    """A scenario ready to build, with what is odd about it.

    Raises:
        ScenarioError: The file cannot be used.
    """
    scenario, diagnostics = open_scenario(path, strict=strict, limits=limits)
    return scenario, [_finding(d) for d in diagnostics]


def default_time_limit(scenario: ResolvedScenario, env: Env) -> float:
    """max(30 s, 4 x the longest way from start over its goals / that robot's top speed) [s]."""
    longest = 0.0
    for view in env.robot_list:
        points = [view.position[:, 0], *(goal[:2, 0] for goal in view.goals)]
        way = sum(math.dist(a, b) for a, b in itertools.pairwise(points))
        if view.max_speed > 0:
            longest = max(longest, way / view.max_speed)
    return max(_MIN_HORIZON, _HORIZON_FACTOR * longest)


def _source(path: str | Path | None, text: str | None, limits: Limits | None) -> str | Document:
    if (path is None) == (text is None):
        raise ValueError("give either a path or a text")
    if path is not None:
        return locate(path)
    assert text is not None
    return load_text(text, limits=limits or DEFAULT_LIMITS)


def _finding(diagnostic: Diagnostic) -> Finding:
    allowed = diagnostic.allowed
    return Finding(
        code=diagnostic.code,
        severity=diagnostic.severity,
        path=format_path(diagnostic.path),
        line=diagnostic.line,
        column=diagnostic.column,
        length=diagnostic.length,
        message=diagnostic.message,
        given=diagnostic.given,
        allowed=allowed if allowed is None or isinstance(allowed, str) else list(allowed),
        fix=diagnostic.fix,
        tolerated=diagnostic.tolerated,
    )


def _horizon(
    scenario: ResolvedScenario, env: Env, steps: int | None
) -> tuple[int, Literal["argument", "scenario", "default"]]:
    if steps is not None:
        return steps, "argument"
    limit = scenario.world.time_limit
    if limit is not None:
        return math.ceil(limit / env.step_time - 1e-9), "scenario"
    return math.ceil(default_time_limit(scenario, env) / env.step_time - 1e-9), "default"


def _advance(env: Env, steps: int, progress: Progress | None, *, until_done: bool = True) -> None:
    done = 0
    while done < steps and not (until_done and env.done()):
        done += max(1, env.advance(min(_CHUNK_STEPS, steps - done), until_done=until_done))
        if progress is not None:
            progress(done, steps)


def _animate(env: Env, steps: int, save: Path | None, progress: Progress | None) -> list[str]:
    env.save_ani = save is not None
    env.render()
    for step in range(steps):
        if env.done():
            break
        env.step()
        env.render(env.step_time)
        if progress is not None:
            progress(step + 1, steps)
    if save is None:
        return []
    env.save_ani = False
    return [str(env._env_plot.save_animation(path=save))]


def _run_result(
    env: Env,
    path: str,
    horizon: int,
    source: Literal["argument", "scenario", "default"],
    warnings: list[Finding],
    files: list[str],
    imports: Sequence[str],
    strict: bool,
) -> RunResult:
    from irsim import __version__

    events = env.events
    outcomes = robot_outcomes(env.simulation)
    arrivals = first_events(events, "arrival")
    robots = []
    for view in env.robot_list:
        ended = outcomes[view.name]
        goal = view.goal
        arrival = arrivals.get(view.name)
        robots.append(
            RobotResult(
                name=view.name,
                outcome="timeout" if ended == "running" else ended,
                time_to_goal=None if arrival is None else arrival.time,
                collision_count=sum(e.kind == "collision" and view.name in (e.object, e.partner) for e in events),
                path_length=_path_length(env, view.row),
                distance_to_goal=None if goal is None else float(np.linalg.norm(goal[:2] - view.position)),
                pose=(float(view.state[0, 0]), float(view.state[1, 0]), float(view.state[2, 0])),
            )
        )
    ends = [robot.outcome for robot in robots]
    outcome: Literal["success", "collision", "timeout"] = "timeout"
    if ends and all(end == "success" for end in ends):
        outcome = "success"
    elif "collision" in ends:
        outcome = "collision"
    given = horizon if source == "argument" else None
    return RunResult(
        scenario=path,
        seed=env.seed,
        outcome=outcome,
        summary=_summary(robots, events, env.sim_time),
        steps=int(env.simulation.count[0]),
        sim_time=env.sim_time,
        time_limit=horizon * env.step_time,
        time_limit_from=source,
        robots=robots,
        events=[EventRecord(**{k: getattr(e, k) for k in EventRecord.model_fields}) for e in events[:_MAX_EVENTS]],
        event_count=len(events),
        warnings=warnings,
        files=files,
        version=__version__,
        reproduce=_command("run", path, env.seed, given, strict, imports),
    )


def _path_length(env: Env, row: int) -> float:
    track = env.simulation.state.trajectory(row)[:, :2]
    points = np.vstack([env.simulation.state.initial_state(row)[None, :2], track])
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _summary(robots: list[RobotResult], events: Sequence[Event], sim_time: float) -> str:
    if not robots:
        return f"no robots; {sim_time:.1f} s simulated"
    arrived = sum(robot.outcome == "success" for robot in robots)
    text = f"{arrived} of {len(robots)} robots arrived" if len(robots) > 1 else ""
    if len(robots) == 1:
        text = {
            "success": "the robot arrived",
            "collision": "the robot collided",
            "timeout": "the robot did not arrive",
        }[robots[0].outcome]
    text += f" within {sim_time:.1f} s"
    names = {robot.name for robot in robots}
    first = next((e for e in events if e.kind == "collision" and names & {e.object, e.partner}), None)
    if first is not None:
        text += f"; {first.object} hit {first.partner} at {first.time:.1f} s near ({first.x:.2f}, {first.y:.2f})"
    return text


def _command(
    verb: str,
    path: str | Path,
    seed: int,
    steps: int | None,
    strict: bool,
    imports: Sequence[str],
    extra: Sequence[str] = (),
) -> str:
    words = ["irsim", verb, str(path), "--seed", str(seed)]
    if steps is not None:
        words += ["--steps", str(steps)]
    if strict:
        words.append("--strict")
    for name in imports:
        words += ["--import", name]
    return shlex.join([*words, *extra])
