import numpy as np

import irsim
from report import show

env = irsim.make("field.yaml", display=False)
robot = env.robot
show("goal", robot.goal)
robot.set_goal([3, 4, 0])
show("list", robot.goal)
robot.set_goal(np.array([[5.0], [4.0], [1.0]]))
show("column", robot.goal)
robot.set_goal(np.array([5.0, 4.5, 1.0]))
show("array", robot.goal)
robot.set_goal([[2, 1, 0], [3, 1, 0]])
show("waypoints", robot.goal)
robot.append_goal([4, 4, 0])
for _ in range(20):
    env.step()
show("after", [robot.goal, robot.state, robot.arrive])
robot.set_goal([8, 8, 0], init=True)
env.reset()
show("reset", robot.goal)
robot.set_goal(None)
show("none", robot.goal)
show("check", [robot.check_arrive(np.array([[1.0], [1.05], [0.0]])), robot.check_arrive(None)])
show("near", robot.check_arrive(np.array([[1.5], [1.05], [0.0]]), threshold=1.0))
show("vertices", env.robot_list[1].goal_vertices)
env.end(ending_time=0)
