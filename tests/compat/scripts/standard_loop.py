import irsim
from report import show

env = irsim.make("field.yaml", display=False)
for i in range(300):
    env.step()
    env.render(0.05)
    if i % 25 == 0:
        show("time", env.time)
        show("status", env.status)
        show("robot", env.robot.state)
    if env.done():
        break
show("steps", i)
show("all", env.done())
show("any", env.done(mode="any"))
show("arrive", [r.arrive for r in env.robot_list])
show("collision", [r.collision for r in env.robot_list])
env.end(ending_time=0)
