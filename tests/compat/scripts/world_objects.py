import irsim
from irsim.world import World
from irsim.world.map import FogMap
from report import show

world = World("small", height=4, width=6, step_time=0.2, offset=[1, 2])
show("ranges", [world.x_range, world.y_range, world.count, world.sampling])
world.step()
show("time", [world.time, world.count])
world.reset()
show("reset", [world.time, world.count])
fog = FogMap(width=4, height=2, resolution=0.5)
show("fog", [fog.shape, fog.explored_ratio])
fog.reveal_fov([1.0, 1.0, 0.0], 1.0, 1.0)
show("some", bool(0 < fog.explored_ratio < 1))
fog.reset()
show("none", fog.explored_ratio)
