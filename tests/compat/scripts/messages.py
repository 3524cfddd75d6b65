import irsim
from irsim.msg import Odometry, Pose, Quaternion
from report import show

env = irsim.make("field.yaml", display=False)
for _ in range(3):
    env.step()
message = env.get_msg()
show("world", [message.name, message.status, message.step_time, message.header.seq, message.header.frame_id])
show("stamp", float(message.header.stamp))
show("robots", [o.name for o in message.robots])
show("obstacles", [o.name for o in message.obstacles])
for o in message.objects[:3]:
    show("object", [o.id, o.name, o.role, o.kinematics, o.shape, o.static, o.arrive, o.collision, o.collision_ids])
    show("pose", [o.odom.pose.pose.position.x, o.odom.pose.pose.position.y, o.odom.pose.pose.orientation.to_yaw()])
    show("twist", [o.odom.twist.twist.linear.x, o.odom.twist.twist.linear.y, o.odom.twist.twist.angular.z])
scan = message.robots[0].scan
show("scan", [scan.angle_min, scan.angle_max, scan.angle_increment, scan.range_max, len(scan.ranges)])
show("infinite", float(env.get_msg(use_inf=True).robots[0].scan.ranges[0]))
show("keys", sorted(message.to_dict()))
odom = Odometry()
odom.pose.pose = Pose(orientation=Quaternion.from_yaw(1.0))
odom.pose.pose.position.x, odom.pose.pose.position.y = 3.0, 2.0
odom.twist.twist.linear.x = 0.4
show("applied", env.receive_msg(odom, object_name="helper"))
show("moved", [env.robot_list[1].state, env.robot_list[1].velocity])
show("all", env.receive_msg(env.get_msg()))
env.end(ending_time=0)
