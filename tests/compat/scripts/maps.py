import numpy as np
import shapely

import irsim
from irsim.world.map import Map
from report import show

env = irsim.make("field.yaml", display=False)
map_ = env.get_map(0.5)
show("resolution", map_.grid_resolution)
show("grid", map_.grid is None)
show("free", map_.is_collision(shapely.Point(1, 1).buffer(0.2)))
show("hit", map_.is_collision(shapely.Point(4, 4).buffer(0.2)))
show("outside", map_.is_collision(shapely.Point(0, 0).buffer(0.2)))
grid = np.zeros((4, 4))
grid[2, 1] = 100
own = Map(width=4, height=4, resolution=1, grid=grid)
show("own", [own.grid_resolution, own.grid_occupied(2.5, 1.5), own.grid_occupied(1.5, 2.5), own.grid_occupied(9, 9)])
show("collides", [own.is_collision(shapely.box(2.2, 1.2, 2.4, 1.4)), own.is_collision(shapely.box(0.2, 0.2, 0.4, 0.4))])
env.end(ending_time=0)
