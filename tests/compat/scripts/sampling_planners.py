import numpy as np

import irsim
from irsim.lib.path_planners.informed_rrt_star import InformedRRTStar
from irsim.lib.path_planners.probabilistic_road_map import PRMPlanner
from irsim.lib.path_planners.rrt import RRT
from irsim.lib.path_planners.rrt_star import RRTStar
from report import show

env = irsim.make("collisions.yaml", display=False, seed=1)
map_ = env.get_map()
start, goal = env.robot.state, env.robot.goal
for planner in (
    RRT(map_, env.robot, max_iter=3000),
    RRTStar(map_, env.robot, max_iter=1500),
    InformedRRTStar(map_, env.robot, max_iter=800),
):
    path = planner.planning(start, goal, show_animation=False)
    show("goal first", bool(np.linalg.norm(path[:, 0] - [9, 5]) < 1e-6))
    show("start last", bool(np.linalg.norm(path[:, -1] - [1, 5]) < 1e-6))
planner = PRMPlanner(map_, 0.3, n_sample=600)
path = planner.planning(start, goal, show_animation=False)
show("road map", [path.shape[0], bool(np.linalg.norm(path[:, 0] - [9, 5]) < 1e-6)])
env.end(ending_time=0)
