import numpy as np

import irsim
from report import show

env = irsim.make("field.yaml", display=False)
env.draw_trajectory([np.array([[1.0], [1.0]]), np.array([[2.0], [3.0]])], traj_type="r--", label="path")
env.draw_trajectory(np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 1.0]]), refresh=True)
env.draw_points([np.array([[1.0], [2.0]]), np.array([[3.0], [2.0]])], s=10, c="b")
env.draw_points(np.array([[1.0, 2.0], [3.0, 4.0]]), refresh=False)
env.draw_points(None)
env.draw_box(np.array([[1.0, 2.0, 2.0, 1.0], [1.0, 1.0, 2.0, 2.0]]), refresh=True, color="-r")
env.draw_quiver(np.array([1.0, 1.0, 0.5, 0.5]), refresh=True)
env.draw_quivers([np.array([1.0, 1.0, 0.5, 0.5]), np.array([2.0, 1.0, 0.5, 0.5])])
env.step()
env.render(0.01, goal_color="b", show_trail=True)
env.render(0.0, mode="all")
env.robot.set_text("boss")
env.robot.set_goal_text("there")
env.robot.set_laser_color([1, 2, 3], "blue", 0.5)
env.robot.plot_clear(all=True)
env.reset_plot()
show("figure", [env._env_plot.fig is not None, env._env_plot.ax is not None])
show("limits", [list(env._env_plot.ax.get_xlim()), list(env._env_plot.ax.get_ylim())])
env.end(ending_time=0)
