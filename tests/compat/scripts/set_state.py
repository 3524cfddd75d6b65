import numpy as np

import irsim
from report import error_of, show

env = irsim.make("field.yaml", display=False)
robot = env.robot
robot.set_state([2, 2, 0.5])
show("state", robot.state)
show("vertices", env.robot_list[1].vertices)
env.robot_list[1].set_state(np.array([[3.0], [3.0], [1.0]]))
show("moved", env.robot_list[1].vertices)
robot.set_velocity([0.5, 0.1])
show("velocity", robot.velocity)
robot.set_state([4, 2, 0], init=True)
robot.set_velocity([0.2, 0.0], init=True)
env.step()
env.reset()
show("after reset", [robot.state, robot.velocity])
show("wrong", error_of(robot.set_state, [1, 2, 3, 4, 5]))
show("check", robot.input_state_check([1, 2], 3))
show("longer", robot.input_state_check([1, 2, 3, 4], 3))
env.end(ending_time=0)
