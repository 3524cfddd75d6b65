import irsim
from report import show

env = irsim.make("field.yaml", display=False)
env.step()
env.reload()
show("again", [env.time, env.robot.state, env.robot_number])
env.reload("collisions.yaml")
show("other", [env.time, env.robot.state, env.robot_number])
env.step()
show("step", [env.time, env.robot.state])
env.reset(random=True)
show("random", [env.time, env.robot_number, [o.id for o in env.objects]])
show("parsed", sorted(env.env_config.parse))
show("file", [env.env_config.world_name, env.env_config.world_file_path.endswith("collisions.yaml")])
env.end(ending_time=0)
