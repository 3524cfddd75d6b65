import numpy as np

import irsim
from irsim.lib import register_behavior
from report import show


@register_behavior("diff", "spiral")
def spiral(ego_object, external_objects, **kwargs):
    if ego_object.state[0, 0] < 1.2:
        show("options", sorted(kwargs))
        show("others", [o.name for o in external_objects])
    return np.array([[kwargs["speed"]], [0.3]])


env = irsim.make("custom.yaml", display=False)
for _ in range(5):
    env.step()
show("state", env.robot.state)
show("velocity", env.robot.velocity)
env.end(ending_time=0)
