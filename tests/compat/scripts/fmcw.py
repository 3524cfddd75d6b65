import irsim
from report import show

env = irsim.make("fmcw.yaml", display=False)
for _ in range(3):
    env.step()
scan = env.get_lidar_scan()
show("ranges", scan["ranges"])
show("radial", scan["radial_velocity"])
show("valid", scan["valid"])
show("keys", sorted(scan))
show("type", env.robot.lidar.sensor_type)
env.render(0)
env.end(ending_time=0)
