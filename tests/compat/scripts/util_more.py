import numpy as np

import irsim.util
from irsim.util import file_check, find_file, geometry_transform, time_it
from irsim.util.random import random_uniform, rng, set_seed
from irsim.util.util import ClipTo2Pi, points_to_xy_list, to_numpy, traj_to_xy_list, vel_omni2world, vel_world2omni
from report import show
from shapely import Point

show("geometry", list(geometry_transform(Point(1, 0), np.array([[1.0], [2.0], [np.pi / 2]])).coords[0]))
show("file", [file_check("no_such_file.yaml") is None, find_file(".", "no_such_file.yaml") is None])
show("found", file_check("field.yaml") is not None)
set_seed(4)
show("draws", [random_uniform([0, 0, 0], [1, 1, 1], (3, 4)).shape, bool(0 <= rng.random() < 1)])
show("clip", [ClipTo2Pi(7.0), ClipTo2Pi(-1.0), ClipTo2Pi(2.0)])
show("numpy", to_numpy([1, 2, 3]))
show("trajectory", traj_to_xy_list([np.array([[1.0], [2.0], [0.0]]), np.array([[3.0], [4.0], [0.0]])]))
show("points", points_to_xy_list(np.array([[1.0, 3.0], [2.0, 4.0]])))
velocity = np.array([[1.0], [0.5]])
show("omni", [vel_world2omni(0.4, velocity), vel_omni2world(0.4, velocity)])


@time_it("sum")
def add():
    return 3


show("timed", add())
show("names", sorted(n for n in ("WrapToPi", "distance", "rng", "set_seed") if hasattr(irsim.util, n)))
