"""The metric ``contacts_between_steps`` of an episode worked by hand."""

from __future__ import annotations

import numpy as np

from irsim.metrics.episode import episode_metrics
from tests.metrics.test_robot_metrics import event, scenario, straight, trace


def test_contacts_between_steps_count_until_it_arrives_and_are_no_collisions() -> None:
    rest = "obstacle:\n  - {shape: {name: circle, radius: 0.2}, state: [9, 9]}\n"
    rest += "  - {shape: {name: circle, radius: 0.2}, state: [3, 9], unobstructed: true}\n"
    resolved = scenario(([1, 5], [4, 5]), rest=rest)
    robot, wall, ghost = (record.name for record in resolved.objects)
    pose = np.concatenate([straight(35)[:, None], np.tile([[9.0, 9], [3, 9]], (36, 1, 1))], axis=1)
    events = [
        event("contact_between_steps", 3, robot, wall),
        event("passed_through", 9, wall, robot),
        event("passed_through", 14, robot, ghost),
        event("arrival", 30, robot),
        event("contact_between_steps", 33, robot, wall),
    ]
    metrics = episode_metrics(trace(resolved, pose, [[4, 5]]), resolved, events)
    keys = ("contacts_between_steps", "collision_count", "collision_steps", "success")
    assert [metrics.robots[0][key] for key in keys] == [2, 0, 0, 1]
    assert metrics.episode["contacts_between_steps"] == 2
