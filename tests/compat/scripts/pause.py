import irsim
from report import show

env = irsim.make("field.yaml", display=False)
env.pause()
show("paused", [env.status, env.pause_flag])
env.step()
show("time", env.time)
env.resume()
show("resumed", [env.status, env.pause_flag])
env.step()
show("time", env.time)
env.set_status("Thinking")
show("status", env.status)
env.set_title("A title")
env.debug_flag = True
env.step()
show("debug", env.time)
env.debug_count = env._world.count + 2
env.step()
env.step()
env.step()
show("debug steps", env.time)
env.debug_flag = False
env.step()
show("goes on", env.time)
try:
    env.quit_flag = True
    env.step()
except SystemExit as done:
    show("quit", done.code)
