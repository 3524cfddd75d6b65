import numpy as np

import irsim
from irsim.lib.behavior.behavior_registry import register_group_behavior, register_group_behavior_class
from report import show


@register_group_behavior("omni", "march")
def march(members, **kwargs):
    return [np.array([[kwargs["speed"]], [0.1 * i]]) for i, _ in enumerate(members)]


@register_group_behavior_class("omni", "halt")
class Halt:
    def __init__(self, members, **kwargs):
        show("members", len(members))

    def __call__(self, members, **kwargs):
        return [None, *[np.array([[0.0], [0.2]]) for _ in members[1:]]]


env = irsim.make("custom_group.yaml", display=False)
for _ in range(4):
    env.step()
for robot in env.robot_list:
    show(robot.name, robot.state)
env.end(ending_time=0)
