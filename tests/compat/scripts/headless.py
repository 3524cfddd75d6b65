import irsim
from report import show

env = irsim.make("field.yaml", headless=True, seed=1)
for _ in range(3):
    env.step()
    env.render(0.05)
env.draw_points([[1, 2]])
show("time", env.time)
show("flag", env.disable_all_plot)
env.end()
env = irsim.make("field.yaml", disable_all_plot=True)
env.step()
env.render()
show("also", env.time)
env.end()
