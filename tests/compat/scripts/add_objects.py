import irsim
from report import error_of, show

env = irsim.make("field.yaml", display=False)
robot = env.create_robot(
    kinematics={"name": "diff"}, shape={"name": "circle", "radius": 0.3}, state=[2, 3, 0], name="new"
)
show("made", [robot.name, robot.state, robot.goal, robot.role])
show("not yet", env.robot_number)
env.add_object(robot)
show("added", [env.robot_number, [o.name for o in env.objects]])
box = env.create_obstacle(shape={"name": "rectangle", "length": 1, "width": 1}, state=[10, 8, 0], name="box")
ball = env.create_obstacle(shape={"name": "circle", "radius": 0.5}, state=[11, 5, 0], name="ball")
env.add_objects([box, ball])
show("names", env.names)
robot.set_goal([5, 3, 0])
for _ in range(5):
    env.step([0.5, 0.1], robot.id)
show("moved", robot.state)
again = env.create_obstacle(shape={"name": "circle"}, name="box")
show("twice", error_of(env.add_object, again))
env.validate_unique_names()
env.delete_object(ball.id)
show("deleted", env.names)
env.delete_objects([box.id, 999])
show("deleted too", env.names)
env.build_tree()
env.step()
show("goes on", [env.time, env.robot.state])
env.end(ending_time=0)
