"""A scenario of robots that do not know the truth, whose pages show what they believe."""

from __future__ import annotations

SCENE = """\
world: {width: 12, height: 8, time_limit: 9}
robot:
  - name: lost
    kinematics: {name: diff}
    shape: {name: rectangle, length: 0.6, width: 0.4}
    state: [1, 2, 0]
    goal: [6, 2, 0]
    behavior: {name: dash}
    perceives: both
    sensors:
      - {name: odometry, scale_error: 0.2}
      - {name: localization, position_std: 0.3, heading_std: 0.1, time: 0.5}
      - {name: detector, false_tracks: 2, keep: 1}
  - name: sure
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.25}
    state: [1, 6, 0]
    goal: [9, 6, 0]
    behavior: {name: dash}
"""
