import irsim
from report import show

env = irsim.make("fog.yaml", display=False)
fog = env._world.fog_map
show("shape", fog.shape)
for i in range(20):
    env.step()
    if i % 5 == 0:
        show("explored", fog.explored_ratio)
env.render(0)
env.reset()
show("reset", bool(env._world.fog_map.explored_ratio < 0.2))
env.end(ending_time=0)
