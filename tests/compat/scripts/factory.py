import irsim
from irsim.world import ObjectFactory
from irsim.world.object_group import ObjectGroup
from report import show

env = irsim.make("field.yaml", headless=True)
factory = env.object_factory
show("type", isinstance(factory, ObjectFactory))
states, goals = factory.generate_state_list(3, {"name": "manual"}, [1, 2, 0], [3, 4, 0])
show("states", [list(map(float, s)) for s in states])
show("goals", [list(map(float, g)) for g in goals])
robot = factory.create_robot(kinematics={"name": "omni"}, state=[1, 2, 0])
show("robot", [robot.kinematics, robot.role])
obstacle = factory.create_obstacle(state=[1, 2, 0])
show("obstacle", [obstacle.kinematics, obstacle.role, obstacle.static])
group = ObjectGroup(env.robot_list[:2], 7)
show("group", [group.number, group.role, len(group), [o.name for o in group]])
env.end()
