import numpy as np

import irsim
from report import show

env = irsim.make("field.yaml", display=False)
robot = env.robot
show("behavior", robot.gen_behavior_vel())
show("given", robot.gen_behavior_vel(np.array([[9.0], [0.1]])))
show("step", robot.step(np.array([[0.5], [0.2]])))
show("state", robot.state)
robot.sensor_step()
robot.refresh()
robot.check_status()
robot.check_arrive_status()
robot.check_collision_status()
show("done", robot.done())
show("desired", robot.get_desired_omni_vel())
show("normalized", robot.get_desired_omni_vel(normalized=True))
show("far", robot.get_desired_omni_vel(goal_threshold=100))
robot.reset()
show("reset", robot.state)
show("body", env.robot_list[1].vel_world2body(np.array([[1.0], [0.5]])))
show("info", [robot.get_info().name, env.obstacle_list[0].get_obstacle_info().radius])
env.end(ending_time=0)
