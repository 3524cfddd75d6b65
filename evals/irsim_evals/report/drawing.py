"""Draws the world of an answer at one or more times. Runs in a limited process: the answer is untrusted input."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from irsim.diagnostics.errors import IrsimError
from irsim.graphics.encoding.pixels import to_image
from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.layers import opaque_colors
from irsim.rendering.snapshot import legible_scene, png_of
from irsim.scenario.behavior_override import parse_behavior, with_behavior
from irsim_evals.grader.episode import run_episode
from irsim_evals.grader.material import open_text, write_files
from irsim_evals.grader.scene import open_scene
from irsim_evals.report.pictures import Drawn, Job

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["draw_answer"]

_LONGER_SIDE_PX = 400
_SHORTEST_SIDE_PX = 60
"""A world that is much longer than wide is shown with a margin, so that its picture has at least this side [px]."""
_DPI = 80.0
_MAX_STEPS = 20_000
"""Steps that are simulated for the picture of the end."""


def draw_answer(job: Job) -> list[Drawn] | str:
    """The world of a scenario at its start and at the end of an episode; a sentence if it cannot be drawn."""
    try:
        with tempfile.TemporaryDirectory() as folder:
            return _both(job, Path(folder))
    except IrsimError as error:
        return f"The world cannot be built: {str(error).splitlines()[0][:200]}"
    except Exception as error:  # an untrusted scenario may break the drawing, but not the report
        return f"The drawing failed: {type(error).__name__}: {error}"[:200]


def _both(job: Job, folder: Path) -> list[Drawn] | str:
    """Both pictures, with maps in a temporary folder."""
    if job.pictures:
        write_files(folder, {job.name: job.text}, job.pictures)
    opened = open_text(job.text, folder if job.pictures else None, job.name)
    scenario = opened.scenario
    if scenario is None:
        return f"The simulator cannot read the scenario: {opened.why}"[:300]
    start = open_scene(scenario, job.start_seed)
    first = _draw(start.env.simulation, job.start_seed)
    seconds = min(job.seconds, _MAX_STEPS * float(start.world.step_time))
    if job.behavior is not None:
        scenario = with_behavior(opened.document, parse_behavior(job.behavior), strict=False)
    episode = run_episode(scenario, job.end_seed, seconds)
    return [first, _draw(episode.scene.env.simulation, job.end_seed)]


def _draw(simulation: Simulation, seed: int) -> Drawn:
    scene, pictures = legible_scene(simulation)
    x0, x1, y0, y1 = scene.extent
    scale = _LONGER_SIDE_PX / max(x1 - x0, y1 - y0)
    width, height = (max(_SHORTEST_SIDE_PX, round(side * scale)) for side in (x1 - x0, y1 - y0))
    more_x, more_y = (width / scale - (x1 - x0)) / 2, (height / scale - (y1 - y0)) / 2
    extent = (x0 - more_x, x1 + more_x, y0 - more_y, y1 + more_y)
    scene.look_at(extent)
    figure = SceneFigure((width, height), _DPI, axis=False, tight=False, pictures=pictures, halo=True)
    figure.figure.subplots_adjust(left=0, right=1, bottom=0, top=1)
    figure.show(scene, None)
    pixels, _ = figure.pixels(tight=False)
    image = to_image(pixels)
    return Drawn(png_of(image, opaque_colors(scene)), extent, image.size, float(scene.time), seed)
