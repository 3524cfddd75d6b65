import irsim
from report import show

env = irsim.make("field.yaml", display=False)
scan = env.get_lidar_scan()
show("ranges at make", scan["ranges"])
env.step()
scan = env.get_lidar_scan(0)
for key in ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max"):
    show(key, scan[key])
show("ranges", scan["ranges"])
show("valid", scan["valid"])
show("intensities", scan["intensities"])
show("offset", env.get_lidar_offset())
robot = env.robot
show("robot scan", robot.get_lidar_scan()["ranges"])
show("points", robot.get_lidar_points())
show("robot offset", robot.get_lidar_offset())
lidar = robot.lidar
show("number", lidar.number)
show("type", lidar.sensor_type)
show("angles", lidar.angle_list)
show("range", [lidar.range_min, lidar.range_max, lidar.angle_min, lidar.angle_max, lidar.angle_inc])
show("data", lidar.range_data)
show("origin", lidar.lidar_origin)
show("cloud", lidar.scan_to_pointcloud())
show("points too", lidar.get_points())
show("noise", [lidar.noise, lidar.std])
show("sensors", [s.sensor_type for s in robot.sensors])
env.end(ending_time=0)
