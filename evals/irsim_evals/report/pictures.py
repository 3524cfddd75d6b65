"""Pictures of the worlds in a report: each drawn once, in a limited process, and only as many as the page can hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from irsim.common.hashing import digest
from irsim_evals.grader.artefact import Answer, find_scenario
from irsim_evals.grader.limited import LimitError, preload, run_all
from irsim_evals.report.load import Asked
from irsim_evals.results import Trial

__all__ = ["Drawn", "Gallery", "Job", "draw_trials", "main_file"]

_SECONDS = 30.0
"""Time after which the drawing of one answer is ended [s]."""
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
        size: Size of all pictures [B].
    """

    pictures: dict[str, Drawn] = field(default_factory=dict)
    shown: dict[int, list[str] | str] = field(default_factory=dict)
    size: int = 0


def main_file(trial: Trial, asked: Asked) -> tuple[str, str] | None:
    """Name and text of the scenario that was graded; None without a scenario."""
    return find_scenario(Answer("", trial.verdict.files, trial.reply), asked.given)


def draw_trials(
    trials: Sequence[Trial], asked: Sequence[Asked], progress: Callable[[int, int], None] | None = None
) -> Gallery:
    """Draw the worlds of all trials that could be built, at the start and at the end.

    Args:
        trials: The trials.
        asked: The question of each trial's case.
        progress: Callback ``(done, total)``.
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
    made = _draw_all(jobs, progress)
    for number, name in wanted.items():
        gallery.shown[number] = _keep(gallery, name, made[name])
    return gallery


def _draw_all(jobs: dict[str, Job], progress: Callable[[int, int], None] | None) -> dict[str, list[Drawn] | str]:
    preload("irsim_evals.report.drawing", "matplotlib.backends.backend_agg")
    made: dict[str, list[Drawn] | str] = {}
    for name, drawn in zip(
        jobs, run_all(_draw, [(job,) for job in jobs.values()], None, _SECONDS, "drawing"), strict=True
    ):
        made[name] = f"There is no picture: {drawn}." if isinstance(drawn, LimitError) else drawn
        if progress is not None:
            progress(len(made), len(jobs))
    return made


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
        size = sum(len(one.png) for one in drawn)
        if gallery.size + size > _MAX_BYTES:
            return "The page holds no more pictures; draw this one with irsim render."
        gallery.size += size
        gallery.pictures.update(zip(names, drawn, strict=True))
    return names


def _job(trial: Trial, asked: Asked, scenario: tuple[str, str]) -> Job:
    """The job of drawing a trial: worlds with the seeds that the failures were observed with, else with the case's."""
    failed = [one for one in trial.verdict.failed() if one.seed is not None]
    start = next((one.seed for one in failed if one.stage != "behavior"), None)
    end = next((one.seed for one in failed if one.stage == "behavior"), None)
    return Job(
        *scenario,
        start_seed=asked.seed if start is None else start,
        end_seed=asked.episode_seed if end is None else end,
        seconds=asked.episode_seconds,
        behavior=asked.episode_behavior,
        pictures=asked.pictures,
    )
