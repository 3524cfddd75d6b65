import numpy as np

import irsim
from irsim.lib.path_planners.a_star import AStarPlanner
from irsim.lib.path_planners.jps import JPSPlanner
from report import show

env = irsim.make("collisions.yaml", display=False)
map_ = env.get_map(0.25)
for planner in (AStarPlanner(map_), JPSPlanner(map_)):
    path = planner.planning([1, 1], [8, 8], show_animation=False)
    show("shape", path.shape[0])
    show("goal first", bool(np.linalg.norm(path[:, 0] - [8, 8]) < 0.3))
    show("start last", bool(np.linalg.norm(path[:, -1] - [1, 1]) < 0.3))
    length = np.linalg.norm(np.diff(path, axis=1), axis=0).sum()
    show("direct", bool(9.8 <= length <= 11.5))
env.end(ending_time=0)
