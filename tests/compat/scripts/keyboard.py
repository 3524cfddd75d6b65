import irsim
from report import show

env = irsim.make("keyboard.yaml", display=False)
show("mode", [env.world_param.control_mode, env.status])
show("limits", [env.keyboard.key_lv_max, env.keyboard.key_ang_max, env.keyboard.key_id])
env.step()
show("still", [env.robot.state, env.status])
env.keyboard.key_lv = 0.5
env.keyboard.key_ang = 0.2
show("vel", env.key_vel)
env.step()
show("driven", [env.robot.state, env.robot.velocity])
env.end(ending_time=0)
