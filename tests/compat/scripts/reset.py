import irsim
from report import show

env = irsim.make("field.yaml", display=False)
for _ in range(30):
    env.step()
show("before", [env.time, env.robot.state, len(env.robot.trajectory)])
env.reset()
show("after", [env.time, env.status, env.robot.state, env.robot.velocity, len(env.robot.trajectory)])
show("flags", [env.robot.arrive, env.robot.collision, env.robot.stop_flag])
env.step()
show("step", [env.time, env.robot.state])
env.refresh()
show("refresh", [env.time, env.robot.state])
env.reset_plot()
env.close(ending_time=0)
