import numpy as np
from PIL import Image

import irsim
from report import show

pixels = np.full((20, 30), 255, dtype=np.uint8)
pixels[2:6, 10:20] = 0
pixels[15:18, 3:5] = 40
Image.fromarray(pixels).save("my_map.png")
env = irsim.make("image_map.yaml", display=False)
world = env._world
show("grid", [world.grid_map.shape, float(world.grid_map.sum())])
show("columns", world.grid_map.sum(axis=1))
show("rows", world.grid_map.sum(axis=0))
show("reso", world.reso)
show("cells", world.obstacle_positions.shape)
show("first", world.obstacle_positions[:, 0])
show("map object", [env.obstacle_list[-1].shape, env.obstacle_list[-1].name, env.obstacle_number])
env.step()
show("ranges", env.get_lidar_scan()["ranges"])
for _ in range(30):
    env.step()
show("robot", [env.robot.state, env.robot.collision])
env.end(ending_time=0)
