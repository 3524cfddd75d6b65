import irsim
from report import show

env = irsim.make("collisions.yaml", display=False)
for i in range(40):
    env.step()
    if env.robot.collision:
        break
show("step", i)
show("status", env.status)
show("flags", [env.robot.collision, env.robot.stop_flag, env.robot.collision_flag])
show("who", [o.name for o in env.robot.collision_obj])
show("possible", [o.name for o in env.robot.possible_collision_objects])
show("check", [env.robot.check_collision(o) for o in env.obstacle_list])
show("done", env.done())
env.step()
show("stays", [env.robot.velocity, env.robot.state])
env.end(ending_time=0)
