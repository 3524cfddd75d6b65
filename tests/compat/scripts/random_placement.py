import irsim
from report import show

env = irsim.make("field.yaml", display=False, seed=3)
before = env.obstacle_list[0].state.copy()
env.random_obstacle_position([1, 1, -3], [9, 9, 3], ids=[3], non_overlapping=True)
after = env.obstacle_list[0].state
show("moved", bool((before != after).any()))
show("inside", bool(1 <= after[0, 0] <= 9 and 1 <= after[1, 0] <= 9))
show("others stay", env.obstacle_list[1].state)
env.random_polygon_shape(center_range=[0, 0, 0, 0], avg_radius_range=[0.5, 0.6], num_vertices_range=[5, 6])
env.refresh()
show("corners", env.obstacle_list[1].vertices.shape)
show("radius", bool(env.obstacle_list[1].radius < 1.3))
env.robot.set_random_goal(env.obstacle_list, range_limits=[[1, 1, 0], [9, 9, 0]])
show("goal", bool(1 <= env.robot.goal[0, 0] <= 9))
env.set_random_seed(5)
env.end(ending_time=0)
