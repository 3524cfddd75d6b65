import numpy as np

import irsim
from report import error_of, show

env = irsim.make("field.yaml", headless=True)
show("wrong size", error_of(env.step, np.array([1.0, 2.0, 3.0, 4.0, 5.0]), 0))
show("unknown id", error_of(env.step, np.array([1.0, 2.0]), 99))
show("unknown name", error_of(env.step, np.array([1.0, 2.0]), "missing"))
show("two lengths", error_of(env.step, [[1, 0], [1, 0]], [0]))
show("missing projection", error_of(irsim.make, "field.yaml", projection="5d"))
show("unknown keyword", error_of(irsim.make, "field.yaml", colour="red"))
env.end()
