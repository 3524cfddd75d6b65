"""A scene whose robot has one of each sensor that messages of ROS are for."""

from __future__ import annotations

SCENE = """\
world: {width: 12, height: 8, time_limit: 5, zones: [{name: tunnel, rectangle: [2.5, 0, 6, 8]}]}
robot:
  - name: rover
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [1, 4, 0.2]
    goal: [9, 5]
    behavior: {name: dash}
    sensors:
      - {name: detector, keep: 1}
      - {name: lidar2d, number: 5, range_max: 3, angle_range: 2, offset: [0.2, 0, 0], scan_time: 0.2,
         realism: {sweep: true}}
      - {name: imu, offset: [0.1, 0, 0.5], gyro_noise: 0.01, gyro_bias_std: 0.02, accel_noise: 0.05}
      - {name: odometry, distance_noise: 0.05, heading_noise: 0.02, turning_noise: 0.03}
      - {name: gnss, std: 0.5, drift_std: 0.2, blocked: [tunnel], origin: [48.1, 11.6, 520]}
      - {name: sonar, range_max: 3, std: 0.01, std_per_meter: 0.02, offset: [0.2, 0, 0]}
      - {name: sonar, range_max: 9, offset: [-0.2, 0, 3.1416]}
      - {name: ir_range, range_max: 1.5, offset: [0, 0.2, 1.5708]}
      - {name: imu, rate: 4, latency: 0.3}
      - {name: localization, position_std: 0.1, heading_std: 0.03}
obstacle:
  - {name: crate, shape: {name: circle, radius: 0.4}, state: [0, 3.8, 0]}
  - {name: walker, kinematics: {name: omni}, state: [4, 6, 0], goal: [4, 1], behavior: {name: dash},
     shape: {name: circle, radius: 0.3}}
"""
