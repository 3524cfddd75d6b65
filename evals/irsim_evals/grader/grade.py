"""From an answer to a verdict: each stage of the funnel in turn, every assertion with what was observed.

This module trusts the answer with the memory and time of the present process; :mod:`irsim_evals.grader.limited` runs it
in a process with limits.
"""

from __future__ import annotations

import functools
import math
import tempfile
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from irsim.diagnostics.errors import IrsimError
from irsim_evals.cases.drawing import stand_ins
from irsim_evals.cases.store import Instance, given_pictures
from irsim_evals.grader.artefact import Answer, find_scenario, rivals, scenarios_in
from irsim_evals.grader.episode import GradedEpisode, at_start, run_episode, without_noise
from irsim_evals.grader.material import Material, with_speeds
from irsim_evals.grader.outcome import NOT_REACHED, STAGES, Outcome, Stage, Verdict
from irsim_evals.grader.predicates._base import Observation
from irsim_evals.grader.programs import problems_in
from irsim_evals.grader.relations import related
from irsim_evals.grader.sanity import check_goals, check_moves, check_scene, check_sensors, latest_start

__all__ = ["failed_verdict", "grade"]

_FIRST_STEPS = 3
"""Steps that every scenario must survive."""
_MAX_STEPS = 30_000
"""Steps of an episode."""
_MOVING_TIME = 8.0
"""Time [s] after the last start within which every body with a goal and a behavior must have moved."""


def grade(instance: Instance, answer: Answer, *, whole: bool = True) -> Verdict:
    """Grade an answer. Never raises: whatever goes wrong is a failed assertion.

    Args:
        instance: The case.
        answer: The answer.
        whole: Whether every assertion is looked at; otherwise only whether all hold, so that the grading ends at the
            first that does not, and what needs episodes comes last.
    """
    begin = time.perf_counter()
    outcomes: list[Outcome] = []
    files = dict(answer.files)
    workplace = tempfile.TemporaryDirectory(prefix="irsim-evals-", ignore_cleanup_errors=True)
    try:
        for outcome in _outcomes(instance, answer, Path(workplace.name), whole):
            outcomes.append(outcome)
            if not (whole or outcome.passed):
                break
    except Exception as error:  # a fault of the grader must not pass for one of the answer: it is named as such
        seen = f"{type(error).__name__}: {error}"[:300]
        outcomes.append(_said("grader", "load", False, "a grader without faults", seen))
        outcomes += _ungraded(instance, outcomes)
    finally:
        workplace.cleanup()
    return _verdict(instance, answer, outcomes, files, time.perf_counter() - begin)


def _outcomes(instance: Instance, answer: Answer, workplace: Path, whole: bool) -> Iterator[Outcome]:
    """Every stage of the funnel in turn; after a stage without which nothing can be observed, all else has failed."""
    material = yield from _open(instance, answer, workplace, whole)
    if material is None:
        yield from _ungraded(instance, [])
        return
    built = material.scenario is not None
    if built:
        yield from _sanity(instance, material)
    yield from _assertions(instance, material, built)
    if built:
        seed = instance.case.seeds[0]
        seconds = _MOVING_TIME + latest_start(material.scene(seed))
        yield check_moves(run_episode(material.driven_by(None), seed, seconds))
        for plan in instance.case.episodes:
            yield from _episodes(plan, material, whole, instance.case.in_vain)


def failed_verdict(instance: Instance, answer: Answer | None, assertion: str, stage: Stage, observed: str) -> Verdict:
    """The verdict on an answer that could not be looked at."""
    outcomes = [_said(assertion, stage, False, "an answer that can be graded", observed)]
    outcomes += _ungraded(instance, outcomes)
    files = dict(answer.files) if answer is not None else {}
    return _verdict(instance, answer or Answer(""), outcomes, files, 0.0)


def _open(instance: Instance, answer: Answer, workplace: Path, step: bool) -> Generator[Outcome, None, Material | None]:
    """Find, read and check the scenario, and make the first steps or leave them to the episodes.

    Returns:
        The material to observe, without a scenario where none is needed; None if nothing can be.
    """
    case = instance.case
    named_text = find_scenario(answer, case.files)
    if case.python != "any":
        unread = dict.fromkeys([*answer.blobs, *answer.others])
        problems = problems_in({**unread, **answer.files}, case.files, case.python)
        yield _said(
            "only-yaml", "parse", not problems,
            "no program" if case.python == "none" else "programs that only run scenarios",
            "; ".join(problems[:3]) or "so it is",
        )  # fmt: skip
    material = Material(
        answer, selectors=case.select, passable=case.passable, late=case.late, given=case.files,
        given_blobs=given_pictures(instance), stand_ins=stand_ins(case.missing), workplace=workplace,
    )  # fmt: skip
    if case.missing:
        made = [name for name in case.missing if name in material.names]
        yield _said(
            "not-invented", "parse", not made, f"no file in place of the user's {', '.join(case.missing)}",
            ", ".join(made) or "so it is",
        )  # fmt: skip
    if not case.scenario:
        return material
    if named_text is None:
        may = "build" not in case.disposition or len(case.disposition) > 1
        said = bool(answer.reply.strip())
        yield _said(
            "answered", "parse", may and said, "a scenario" + (" or a reply" if may else ""),
            ("a reply and no scenario" if said else "neither a scenario nor a reply") + _unread(answer),
        )  # fmt: skip
        return material if may and said else None
    several = any(item.file or item.predicate.name in ("every_scenario", "comparison") for item in case.check)
    if not several and (others := rivals(answer, case.files, named_text[0])):
        yield _said(
            "one-scenario", "parse", False, "one scenario, or one that the reply names",
            f"nothing says which is meant: {', '.join([named_text[0], *others][:6])}",
        )  # fmt: skip
    material.main, text = named_text
    material.answer = replace(answer, files={**answer.files, material.main: text})
    opened = material.open(material.main)
    document, errors = opened.document, opened.errors
    yield _said(
        "parses", "parse", not document.fatal, "a file that a safe YAML loader reads",
        "; ".join(item.message for item in document.problems[:2]) or material.main,
    )  # fmt: skip
    if document.fatal:
        return None
    yield _said(
        "valid", "schema", not errors, "a scenario without errors and unknown keys",
        "; ".join(f"{'.'.join(map(str, item.path))}: {item.message}" for item in errors[:3]) or "valid",
    )  # fmt: skip
    if opened.scenario is None:
        return None
    material.scenario, material.document, material.findings = opened.scenario, document, opened.findings
    try:
        scene = material.scene(case.seeds[0])
        if step:
            run_episode(material.scenario, case.seeds[0], _FIRST_STEPS * float(scene.world.step_time))
        yield _said("loads", "load", True, "a world that can be stepped", f"{_FIRST_STEPS} steps")
    except IrsimError as error:
        yield _said("loads", "load", False, "a world that can be stepped", str(error).splitlines()[0])
        return None
    return material


def _unread(answer: Answer) -> str:
    """Files that are called like scenarios but do not look like one, or were not opened."""
    names = [
        name for name in answer.files if name.endswith((".yaml", ".yml")) and name not in scenarios_in(answer.files)
    ]
    words = f"; no world, robot or obstacle can be read in {', '.join(names[:3])}" if names else ""
    closed = [f"{name} is {why}" for name, why in answer.others.items() if name.endswith((".yaml", ".yml"))]
    return words + "".join(f"; {text}, and is not opened" for text in closed[:3])


def _sanity(instance: Instance, material: Material) -> Iterator[Outcome]:
    case = instance.case
    for seed in case.seeds:
        results = check_scene(material, material.scene(seed), overlap=not case.overlap)
        yield from (item for item in results if seed == case.seeds[0] or not item.passed)
    yield check_sensors(material.scene(case.seeds[0]))
    yield check_goals(material.scene(case.seeds[0]), in_time=not case.in_vain)


def _assertions(instance: Instance, material: Material, built: bool) -> Iterator[Outcome]:
    case: Any = instance.case
    for item in case.check:
        predicate = item.predicate
        when = item.when or ("always" if predicate.subject == "answer" else "built")
        if (when == "built" and not built) or (when == "unbuilt" and built):
            continue
        if predicate.subject in ("scene", "episode"):
            yield from _observed(item, (_in_scene(material, item, seed) for seed in case.seeds))
        else:
            yield from _observed(item, [lambda item=item: item.predicate.observe(material.other(item.file))])


def _in_scene(material: Material, item: Any, seed: int) -> Any:
    def look() -> Observation:
        about = material.other(item.file)
        scene = about.scene(seed)
        world = at_start(scene) if item.predicate.subject == "episode" else scene
        seen: Observation = related(item.predicate, about, scene).observe(about, world)
        return replace(seen, seed=seed if seen.seed is None else seen.seed)

    return look


def _episodes(plan: Any, material: Material, whole: bool, in_vain: bool) -> Iterator[Outcome]:
    """Run the episodes of a plan one after the other, so that memory holds only the episodes of one seed."""
    seen: dict[str, list[Observation]] = {item.id: [] for item in plan.check}
    watched = any(item.predicate.looks for item in plan.check)
    for seed in plan.seeds:
        run = _runs(plan, material, seed, watched, in_vain)
        for item in plan.check:
            look = _guarded(
                lambda item=item, run=run, seed=seed: related(item.predicate, material, material.scene(seed)).observe(
                    material, run(item.predicate.exact)
                )
            )
            look.seed = seed if look.seed is None else look.seed
            seen[item.id].append(look)
            if not (look.passed or whole) and plan.share == 1:
                yield _outcome(item, look, False)
    for item in plan.check:
        looks = seen[item.id]
        bad = [look for look in looks if not look.passed]
        passed = len(looks) - len(bad) >= plan.share * len(looks) - 1e-9
        chosen = (bad or looks)[0]
        if plan.share < 1:
            chosen.observed = f"{len(looks) - len(bad)} of {len(looks)} episodes; {chosen.observed}"
        yield _outcome(item, chosen, passed)


def _runs(plan: Any, material: Material, seed: int, looks: bool, in_vain: bool) -> Callable[[bool], GradedEpisode]:
    """Runs the episode of a seed when it is asked for first: as written, or without any noise."""

    @functools.cache
    def scenario() -> Any:
        driven = with_speeds(material.driven_by(plan.behavior), material, seed, plan.speed)
        return material.made_solid(driven, seed)

    @functools.cache
    def run(exact: bool) -> GradedEpisode:
        chosen = without_noise(scenario()) if exact else scenario()
        if exact and chosen is scenario():
            return run(False)
        world = material.scene(seed).world  # its time limit ends every run, unless the case is about it
        limit = math.inf if in_vain else world.time_limit or math.inf
        seconds = min(plan.seconds, limit, _MAX_STEPS * float(world.step_time))
        return run_episode(chosen, seed, seconds, looks=looks)

    return run


def _observed(item: Any, looks: Iterable[Any]) -> Iterator[Outcome]:
    """The first observation that fails, or else the first."""
    first: Observation | None = None
    for look in looks:
        observation = _guarded(look)
        first = first or observation
        if not observation.passed:
            first = observation
            break
    if first is not None:
        yield _outcome(item, first, first.passed)


def _guarded(look: Callable[..., Observation]) -> Observation:
    try:
        return look()
    except Exception as error:  # the grader is total: what cannot be observed does not hold
        plain = isinstance(error, IrsimError) or type(error) is LookupError
        seen = str(error).splitlines()[0] if plain else f"{type(error).__name__}: {error}"[:300]
        return Observation(False, "something that can be observed", seen)


def _outcome(item: Any, observation: Observation, passed: bool) -> Outcome:
    expected = f"{item.file}: {observation.expected}" if item.file else observation.expected
    return Outcome(
        assertion=item.id, stage=item.predicate.stage, passed=passed, expected=expected, observed=observation.observed,
        yaml_path=observation.yaml_path, seed=observation.seed, marks=[] if passed else observation.marks,
    )  # fmt: skip


def _said(name: str, stage: Stage, passed: bool, expected: str, observed: str) -> Outcome:
    return Outcome(assertion=name, stage=stage, passed=passed, expected=expected, observed=observed)


def _ungraded(instance: Instance, outcomes: list[Outcome]) -> list[Outcome]:
    """Every assertion that was not reached, as failed."""
    done = {outcome.assertion for outcome in outcomes}
    return [
        _outcome(item, Observation(False, "a scenario to look at", NOT_REACHED), False)
        for item in instance.case.assertions().values()
        if item.id not in done and item.when != "unbuilt"
    ]


def _verdict(
    instance: Instance, answer: Answer, outcomes: list[Outcome], files: dict[str, str], seconds: float
) -> Verdict:
    failed = {item.stage for item in outcomes if not item.passed}
    built = any(item.assertion == "loads" and item.passed for item in outcomes)
    asks = "?" in answer.reply.replace("?`", "")
    return Verdict(
        case=instance.case.id, instance=instance.name, strict=bool(outcomes) and not failed,
        rate=sum(item.passed for item in outcomes) / max(1, len(outcomes)),
        disposition="build" if built else "ask" if asks else "flag" if answer.reply else None,
        reached=next((stage for stage in STAGES if stage in failed), STAGES[-1]),
        outcomes=outcomes, seconds=round(seconds, 3), files=files,
    )  # fmt: skip
