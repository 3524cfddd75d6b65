import irsim
from irsim.world.map import PerlinGridGenerator
from report import show

env = irsim.make("perlin_map.yaml", display=False)
grid = env._world.grid_map
show("grid", [grid.shape, float(grid.sum())])
show("columns", grid.sum(axis=1))
show("rows", grid.sum(axis=0))
generator = PerlinGridGenerator(20, 10, complexity=0.2, fill=0.3, fractal=2, attenuation=0.5, seed=7)
generator.generate()
show("generator", [generator.grid.shape, float(generator.grid.sum())])
env.end(ending_time=0)
