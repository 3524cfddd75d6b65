import numpy as np

from irsim.lib import reciprocal_vel_obs, social_force_model
from report import show

ego = np.array([0.0, 0.0, 0.6, 0.0, 0.3, 1.0, 0.0, 0.0])
others = [np.array([2.0, 0.1, -0.6, 0.0, 0.3]), np.array([1.5, 1.0, 0.0, -0.4, 0.3])]
solver = reciprocal_vel_obs(ego, others, 1.5, 1.5, 1.0, 1.0)
for mode in ("rvo", "hrvo", "vo"):
    show(mode, np.asarray(solver.cal_vel(mode), dtype=float))
walls = reciprocal_vel_obs(ego, [], 1.5, 1.5, 1.0, 1.0, [[1.0, -1.0, 1.0, 1.0]])
show("wall", np.asarray(walls.cal_vel("rvo"), dtype=float))
people = social_force_model(ego, others, [[1.0, -1.0, 1.0, 1.0]])
show("people", np.asarray(people.cal_vel(), dtype=float))
