import irsim
from report import show

env = irsim.make(display=False)
show("name", str(env).split(" (")[0])
show("robots", env.robot_number)
env.step()
show("state", env.robot.state)
env.end(ending_time=0)
