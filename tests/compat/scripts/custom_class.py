import numpy as np

import irsim
from irsim.lib import register_behavior_class
from report import show


@register_behavior_class("diff", "spiral")
class Spiral:
    def __init__(self, object_info, speed=1.0, **kwargs):
        self.speed, self.count = speed, 0
        show("made for", object_info.name)

    def __call__(self, ego_object, external_objects, **kwargs):
        self.count += 1
        return np.array([[self.speed], [0.05 * self.count]])


env = irsim.make("custom.yaml", display=False)
for _ in range(5):
    env.step()
show("state", env.robot.state)
env.reset()
env.step()
show("after reset", env.robot.state)
env.end(ending_time=0)
