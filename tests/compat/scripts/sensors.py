import irsim
from irsim.world.sensors import FMCWLidar2D, Lidar2D
from report import show

env = irsim.make("sensors.yaml", display=False)
for _ in range(2):
    env.step()
robot = env.robot
show("kinds", [isinstance(s, (Lidar2D, FMCWLidar2D)) for s in robot.sensors])
show("first", robot.lidar is robot.sensors[0])
scan = robot.sensors[0].get_scan()
show("ranges", scan["ranges"])
show("velocity", scan["velocity"])
show("tof", robot.sensors[1].get_scan()["ranges"])
show("offset", robot.sensors[1].get_offset())
show("settings", [robot.sensors[1].number, robot.sensors[1].range_max, robot.sensors[1].angle_range])
env.end(ending_time=0)
