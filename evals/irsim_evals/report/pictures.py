"""Pictures of the worlds in a report: each drawn once, in a limited process, and only as many as the page can hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from irsim.common.hashing import digest
from irsim_evals.cases.store import Instance, given_pictures
from irsim_evals.grader.artefact import Answer, find_scenario
from irsim_evals.grader.limited import LimitError, preload, run_all
from irsim_evals.results import Trial

__all__ = ["Drawn", "Gallery", "Job", "draw_trials", "main_file"]

_SECONDS = 30.0
"""Time after which the drawing of one answer is ended [s]."""
_EPISODE_S = 10.0
"""Length of the episode that is drawn where a case has no episodes [s]."""
_MAX_BYTES = 5_000_000
"""Size of all pictures of a page; the failed trials come first."""


@dataclass(frozen=True)
class Job:
    """The worlds to draw: a scenario at its start, and at the end of an episode.

    Attributes:
        name: Name of the scenario's file.
        text: Its text.
        start_seed: Seed of the world at its start.
        end_seed: Seed of the episode.
        seconds: When the episode ends [s].
        behavior: Behavior that drives the robots instead of theirs.
        pictures: Maps that lie beside the scenario: name → content of the file.
    """

    name: str
    text: str
    start_seed: int
    end_seed: int
    seconds: float
    behavior: str | None = None
    pictures: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Drawn:
    """A picture without axes: the whole of it shows ``extent``.

    Attributes:
        png: Content of the file.
        extent: x from, x to, y from, y to [m].
        size: Width and height [px].
        time: Time that it shows [s].
        seed: Seed of the world.
    """

    png: bytes
    extent: tuple[float, float, float, float]
    size: tuple[int, int]
    time: float
    seed: int


@dataclass
class Gallery:
    """The pictures of a report.

    Attributes:
        pictures: Name → picture; the name is a digest of what is drawn.
        shown: Number of a trial → names of its pictures, or a sentence that says why there are no pictures.
    """

    pictures: dict[str, Drawn] = field(default_factory=dict)
    shown: dict[int, list[str] | str] = field(default_factory=dict)


def main_file(trial: Trial, asked: Instance | None) -> tuple[str, str] | None:
    """Name and text of the scenario that was graded; None without a scenario."""
    return find_scenario(Answer("", trial.verdict.files, trial.reply), asked.case.files if asked else {})


def draw_trials(
    trials: Sequence[Trial], asked: Sequence[Instance | None], progress: Callable[[int, int], None] | None = None
) -> Gallery:
    """Draw the worlds of all trials that could be built, at the start and at the end.

    ``asked`` is the case of each trial as far as it is known; ``progress(done, total)`` is called after each drawing.
    """
    gallery = Gallery()
    jobs: dict[str, Job] = {}
    wanted: dict[int, str] = {}
    for number in sorted(range(len(trials)), key=lambda k: trials[k].verdict.strict):
        scenario = main_file(trials[number], asked[number])
        if scenario is None:
            gallery.shown[number] = "There is no scenario to draw."
        elif not any(one.assertion == "loads" and one.passed for one in trials[number].verdict.outcomes):
            gallery.shown[number] = "The world could not be built, so there is nothing to draw."
        else:
            job = _job(trials[number], asked[number], scenario)
            wanted[number] = digest(repr(job))[:16]
            jobs[wanted[number]] = job
    preload("irsim_evals.report.drawing", "matplotlib.backends.backend_agg")
    made: dict[str, list[Drawn] | str] = {}
    answers = run_all(_draw, [(job,) for job in jobs.values()], None, _SECONDS, "drawing")
    for name, drawn in zip(jobs, answers, strict=True):
        made[name] = f"There is no picture: {drawn}." if isinstance(drawn, LimitError) else drawn
        if progress is not None:
            progress(len(made), len(jobs))
    for number, name in wanted.items():
        gallery.shown[number] = _keep(gallery, name, made[name])
    return gallery


def _draw(job: Job) -> list[Drawn] | str:
    """Runs in the limited process, so that only that one imports what draws."""
    from irsim_evals.report.drawing import draw_answer

    return draw_answer(job)


def _keep(gallery: Gallery, name: str, drawn: list[Drawn] | str) -> list[str] | str:
    """Put pictures into the gallery, unless they are there or it is full."""
    if isinstance(drawn, str):
        return drawn
    names = [f"{name}-{number}" for number in range(len(drawn))]
    if names[0] not in gallery.pictures:
        if sum(len(one.png) for one in (*gallery.pictures.values(), *drawn)) > _MAX_BYTES:
            return "The page holds no more pictures; draw this one with irsim render."
        gallery.pictures.update(zip(names, drawn, strict=True))
    return names


def _job(trial: Trial, asked: Instance | None, scenario: tuple[str, str]) -> Job:
    """The job of drawing a trial: worlds with the seeds that the failures were observed with, else with the case's."""
    seeds = {one.stage == "behavior": one.seed for one in reversed(trial.verdict.failed()) if one.seed is not None}
    plan = asked.case.episodes[0] if asked and asked.case.episodes else None
    start = asked.case.seeds[0] if asked else 0
    return Job(
        *scenario, start_seed=seeds.get(False, start), end_seed=seeds.get(True, plan.seeds[0] if plan else start),
        seconds=float(plan.seconds) if plan else _EPISODE_S, behavior=plan.behavior if plan else None,
        pictures=given_pictures(asked) if asked else {},
    )  # fmt: skip
