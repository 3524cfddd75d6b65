import numpy as np

import irsim
from irsim.world.map import GridMapGenerator
from report import show


class Stripes(GridMapGenerator):
    name = "stripes"
    yaml_param_names = ("every",)

    def __init__(self, width, height, every=3):
        super().__init__()
        self.width, self.height, self.every = width, height, every

    def _build_grid(self):
        grid = np.zeros((self.width, self.height))
        grid[:: self.every] = 100
        return grid


env = irsim.make("grid_generator.yaml", display=False)
show("grid", [env._world.grid_map.shape, float(env._world.grid_map.sum())])
show("known", "stripes" in GridMapGenerator.registry)
env.end(ending_time=0)
