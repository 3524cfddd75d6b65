"""How sentences about an episode call its objects."""

from __future__ import annotations

import pytest

import irsim

SCENE = """
world: {{width: 10, height: 6, collision_mode: stop}}
robot: {{kinematics: {{name: diff}}, state: [1, 3, 0], goal: [9, 3], behavior: {{name: dash}}}}
obstacle:
  - {{kinematics: {{name: omni}}, state: [5, 3, 0], shape: {{name: circle, radius: 0.3}}{more}}}
"""


@pytest.mark.parametrize(
    ("more", "name", "called"),
    [
        (", tags: [pedestrian]", "obstacle_1", "the person 'obstacle_1'"),
        (", tags: [pedestrian], name: ada", "ada", "'ada'"),
        ("", "obstacle_1", "'obstacle_1'"),
    ],
)
def test_who_was_hit_is_a_person_if_the_scene_says_so(more: str, name: str, called: str) -> None:
    """Records keep the name, by which commands know the object."""
    text = SCENE.format(more=more)
    run = irsim.run(text=text)
    assert f"'robot_0' hit {called} at" in str(run.reason)
    [event] = [one for one in run.events if one.kind == "collision"]
    assert event.partner == name
    tried = irsim.validate(text=text, simulate=True).dry_run
    assert tried is not None
    assert f"with {called} at" in tried.summary or f"hit {called} at" in tried.summary
