import irsim
from report import show

env = irsim.make("fov.yaml", display=False)
env.step()
show("seen", [o.name for o in env.robot.get_fov_detected_objects()])
show("each", [env.robot.fov_detect_object(o) for o in env.obstacle_list])
show("values", [env.robot.fov, env.robot.fov_radius])
env.render(0)
env.end(ending_time=0)
