import irsim
from report import error_of, show

env = irsim.make("collisions.yaml", display=False, step_mode="external")
show("mode", env.step_mode)
for i in range(5):
    env.robot.set_state([1 + i, 5, 0])
    env.step()
    show("step", [env.time, env.robot.state, env.robot.collision])
show("action", error_of(env.step, [1.0, 0.0]))
env.end(ending_time=0)
