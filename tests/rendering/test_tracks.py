"""Trails and trajectories: drawn onto what stands, with the picture of a drawing from scratch."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.graphics.figure import tracks
from tests.env.driving import Make, take_steps
from tests.rendering.conftest import Picture

MAX_LEVELS = 8
"""Levels (of 256) by which antialiased edges may differ."""
SHOWN = "plot: {show_trail: true, show_trajectory: true, show_goal: true, trail_fill: true, trail_alpha: 0.3}"
CROSSING = f"""
robot:
  number: 6
  kinematics: {{name: %s}}
  shape: %s
  distribution: {{name: circle, radius: 4, center: [5, 5, 0]}}
  color: cycle
  behavior: {{name: dash}}
  {SHOWN}
obstacle:
  - {{state: [5, 8, 0], shape: {{name: rectangle, length: 1, width: 1}}, plot: {{obj_alpha: 0.5}}, unobstructed: true}}
world: {{collision_mode: unobstructed, %s}}
"""
SHAPES = [
    ("diff", "{name: circle, radius: 0.3}"),
    ("omni", "{name: polygon, vertices: [[-0.3, -0.3], [0.5, 0], [-0.3, 0.3]]}"),
    ("acker", "{name: rectangle, length: 0.9, width: 0.5, wheelbase: 0.5}"),
    (
        "diff",
        "{name: compound, parts: [{name: circle, radius: 0.3}, {name: circle, radius: 0.2, center: [0.2, 0.3]}]}",
    ),
]


def inside(env: Any, shot: np.ndarray) -> np.ndarray:
    """The pixels within the axes."""
    box, height = env._env_plot.ax.bbox, shot.shape[0]
    return shot[int(height - box.y1) + 3 : int(height - box.y0) - 3, int(box.x0) + 3 : int(box.x1) - 3]


def difference(first: np.ndarray, second: np.ndarray) -> int:
    return int(np.abs(first.astype(int) - second.astype(int)).max())


@pytest.mark.parametrize(
    ("text", "period"),
    [(CROSSING % (*shape, ""), 4) for shape in SHAPES] + [(CROSSING % (*SHAPES[0], "plot: {viewpoint: robot_0}"), 1)],
    ids=["circle", "polygon", "car", "compound", "the view moves"],
)
def test_a_picture_does_not_depend_on_earlier_pictures(make: Make, picture: Picture, text: str, period: int) -> None:
    often, once = make(text, "often"), make(text, "once")
    for step in range(6 * period):
        often.step()
        once.step()
        if step % period == 0:
            picture(often)
    assert difference(picture(often), picture(once)) <= MAX_LEVELS


def looked_at(env: Any, picture: Picture, steps: int) -> Any:
    """The environment after a number of steps, with a picture of each."""
    for _ in range(steps):
        env.step()
        picture(env)
    return env


def test_the_next_episode_starts_without_tracks(make: Make, picture: Picture) -> None:
    env = make(CROSSING % (*SHAPES[0], ""))
    before = picture(env)
    looked_at(env, picture, 10).reset()
    assert difference(inside(env, picture(env)), inside(env, before)) <= 1


def test_tracks_that_are_no_longer_shown_disappear(make: Make, picture: Picture) -> None:
    env = looked_at(make(CROSSING % (*SHAPES[0], "")), picture, 10)
    shots = []
    for _ in range(2):
        env.render(mode="all", show_trail=False, show_trajectory=False)
        shots.append(picture(env))
        env._env_plot.reset()
    assert difference(*shots) <= 1


def test_a_path_that_crosses_itself_is_nowhere_darker(make: Make, picture: Picture) -> None:
    env = make("""
robot: {kinematics: {name: diff}, state: [5, 3, 0], shape: {name: circle, radius: 0.3}, goal: [9, 9],
        vel_max: [2, 3], plot: {show_trajectory: true, traj_color: black, traj_alpha: 0.5, show_goal: false}}
""")
    for _ in range(14):
        take_steps(env, 5, [1.5, 1.0])
        picture(env)
    env.render(mode="all", obj_alpha=0.0, show_arrow=False)
    levels = inside(env, picture(env)).min(axis=2)
    path = levels[(levels > 100) & (levels < 200)]
    assert path.size > 5000
    assert levels.min() >= 120


def test_only_what_came_new_is_drawn(make: Make, picture: Picture, monkeypatch: pytest.MonkeyPatch) -> None:
    painted: list[int] = []
    paint = tracks.paint

    def counted(canvas: Any, target: Any, ax: Any, marks: Any, *rest: Any) -> None:
        painted.append(len(marks))
        paint(canvas, target, ax, marks, *rest)

    monkeypatch.setattr(tracks, "paint", counted)
    looked_at(make(CROSSING % (*SHAPES[0], "")), picture, 20)
    assert max(painted) <= 6


def test_vector_files_have_all_tracks(make: Make) -> None:
    sizes = []
    for steps in (2, 30):
        env = make(CROSSING % (*SHAPES[0], ""), f"steps{steps}")
        take_steps(env, steps)
        env.render()
        sizes.append(Path(env.save_figure("shot.svg")).stat().st_size)
    assert sizes[1] > 2 * sizes[0]


def test_more_lines_than_masks_are_drawn_alike(make: Make, picture: Picture, monkeypatch: pytest.MonkeyPatch) -> None:
    shots = []
    for most in (tracks.MAX_MASKS, 1):
        monkeypatch.setattr(tracks, "MAX_MASKS", most)
        shots.append(picture(looked_at(make(CROSSING % (*SHAPES[0], ""), f"most{most}"), picture, 12)))
    assert difference(*shots) <= MAX_LEVELS
