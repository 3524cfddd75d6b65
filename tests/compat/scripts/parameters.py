import irsim
from irsim.config import env_param, world_param
from report import show

env = irsim.make("field.yaml", headless=True)
env.step()
show("world", [world_param.time, world_param.count, world_param.step_time, world_param.control_mode])
show("modes", [world_param.collision_mode, world_param.step_mode])
show("physics", [world_param.gravity, world_param.friction, world_param.restitution, world_param.drive_tau])
show("objects", len(env_param.objects))
show("same", env.env_param.logger is env.logger)
paths = env.path_param
show("paths", [paths.ani_path.endswith("animation"), paths.fig_path.endswith("figure")])
show("buffer", paths.ani_buffer_path.endswith("animation_buffer"))
show("of env", env.world_param.time)
env.end()
