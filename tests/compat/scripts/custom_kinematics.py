import numpy as np

import irsim
from irsim.lib import KinematicsHandler, register_kinematics
from report import show


@register_kinematics("hopper")
class Hopper(KinematicsHandler):
    action_dim = 2
    state_dim = 3
    min_state_dim = 3

    def step(self, state, velocity, step_time):
        new = state.copy()
        new[0, 0] += velocity[0, 0] * step_time
        new[1, 0] += 2 * velocity[1, 0] * step_time
        return new

    def velocity_to_xy(self, state, velocity):
        return np.array([[velocity[0, 0]], [2 * velocity[1, 0]]])


env = irsim.make("custom_kinematics.yaml", display=False)
for _ in range(4):
    env.step(np.array([[0.5], [0.25]]), 0)
show("state", env.robot.state)
show("words", [env.robot.kinematics, env.robot.vel_dim, env.robot.state_dim])
show("velocity", env.robot.velocity_xy)
env.end(ending_time=0)
