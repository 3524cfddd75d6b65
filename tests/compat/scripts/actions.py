import numpy as np

import irsim
from report import show

env = irsim.make("field.yaml", display=False)
env.step(np.array([[1.0], [0.3]]))
show("column", [o.state for o in env.robot_list])
env.step(np.array([0.5, -0.3]), 0)
show("array", env.robot.velocity)
env.step([np.array([0.5, 0.1]), np.array([0.2, 0.2])], 0)
show("list", [o.velocity for o in env.robot_list])
env.step([[0.5, 0.1], [0.2, 0.2], [0.3, 0.1]])
show("lists", [o.velocity for o in env.robot_list])
env.step([np.array([0.1, 0.1]), np.array([0.4, 0.2])], [2, 0])
show("ids", [o.velocity for o in env.robot_list])
env.step([1.0, 0.5])
show("flat", env.robot.velocity)
env.step((0.7, 0.5))
show("tuple", env.robot.velocity)
env.step({"helper": [0.3, -0.2]})
show("dict", [o.velocity for o in env.robot_list])
env.step(np.array([0.25, 0.0]), "helper")
show("name", env.robot_list[1].velocity)
env.step([None, [0.1, 0.2]])
show("none inside", [o.velocity for o in env.robot_list])
env.end(ending_time=0)
