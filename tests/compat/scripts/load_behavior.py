import irsim
from report import show

env = irsim.make("load_behavior.yaml", display=False)
env.load_behavior("my_behaviors")
for _ in range(4):
    env.step()
show("state", env.robot.state)
env.end(ending_time=0)
