import numpy as np

import irsim
from report import show

env = irsim.make("field.yaml", projection="3d", display=False)
for _ in range(3):
    env.step()
    env.render(0)
show("type", type(env).__name__)
show("state", env.robot.state)
env.draw_points(np.array([[1.0, 2.0], [1.0, 2.0], [0.0, 1.0]]))
env.draw_trajectory([np.array([[1.0], [1.0], [0.0]]), np.array([[2.0], [3.0], [1.0]])])
show("depth", [env._world.depth, list(env._world.z_range)])
env.end(ending_time=0)
