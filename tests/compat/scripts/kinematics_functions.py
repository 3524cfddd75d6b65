import numpy as np

from irsim.lib import (
    KinematicsFactory,
    ackermann_kinematics,
    differential_kinematics,
    kinematics_factory,
    omni_kinematics,
)
from irsim.lib.algorithm.kinematics import omni_angular_kinematics
from report import error_of, show

pose = np.array([[1.0], [2.0], [0.5]])
show("diff", differential_kinematics(pose, np.array([[1.0], [0.4]]), 0.1))
show("omni", omni_kinematics(pose, np.array([[1.0], [0.4]]), 0.1))
show("omni angular", omni_angular_kinematics(pose, np.array([[1.0], [0.4], [0.2]]), 0.1))
car = np.array([[1.0], [2.0], [0.5], [0.2]])
show("steer", ackermann_kinematics(car, np.array([[1.0], [0.4]]), 0.1, mode="steer", wheelbase=1.5))
show("angular", ackermann_kinematics(car, np.array([[1.0], [0.4]]), 0.1, mode="angular", wheelbase=1.5))
show("factory", sorted(kinematics_factory))
show("wrong", error_of(differential_kinematics, pose, np.array([[1.0]]), 0.1))
handler = KinematicsFactory.create_kinematics(name="diff")
show("handler", handler.step(pose, np.array([[1.0], [0.4]]), 0.1))
