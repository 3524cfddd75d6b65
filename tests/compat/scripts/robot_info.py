import irsim
from report import show

env = irsim.make("field.yaml", display=False)
env.step()
show("state", env.get_robot_state())
info = env.get_robot_info()
for key in (
    "id",
    "shape",
    "kinematics",
    "role",
    "color",
    "static",
    "goal",
    "vel_min",
    "vel_max",
    "acce",
    "angle_range",
):
    show(key, getattr(info, key))
for key in ("goal_threshold", "wheelbase", "G", "h", "cone_type", "convex_flag", "name"):
    show(key, getattr(info, key))
show("helper", env.get_robot_info(1).name)
show("names", [i.name for i in env.get_robot_info_list()])
info.add_property("battery", 0.5)
show("battery", info.battery)
for item in env.get_obstacle_info_list():
    show("center", item.center)
    show("vertex", item.vertex)
    show("velocity", item.velocity)
    show("radius", item.radius)
    show("cone", [item.cone_type, item.convex_flag])
    show("G", item.G)
    show("h", item.h)
env.end(ending_time=0)
