import irsim
from report import show

env = irsim.make("contact.yaml", display=False)
for i in range(40):
    env.step()
robot, box = env.robot, env.obstacle_list[0]
show("robot", robot.state)
show("box", box.state)
show("physics", [robot.mass, robot.friction, robot.restitution, box.mass, box.inertia])
show("kinds", [robot.pushable, robot.passive, box.pushable, box.passive])
show("derived", [robot.friction_force, box.inv_mass, box.inv_inertia, robot.drive_tau])
show("in contact", [robot.contact.in_contact, box.contact.in_contact])
show("contacts", len(env.contacts))
show("status", env.status)
env.end(ending_time=0)
