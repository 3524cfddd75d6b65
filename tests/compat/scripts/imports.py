import importlib

from report import show

NAMES = {
    "irsim": "make EnvBase EnvBase3D __version__",
    "irsim.env": "EnvBase EnvBase3D",
    "irsim.env.env_base": "EnvBase",
    "irsim.env.env_config": "EnvConfig",
    "irsim.env.env_plot": "EnvPlot draw_patch set_patch_property linewidth_from_data_units",
    "irsim.env.env_plot3d": "EnvPlot3D",
    "irsim.env.env_logger": "EnvLogger",
    "irsim.world": "World ObjectBase ObjectFactory ObstacleMap ObjectStatic ObstacleDiff ObstacleOmni ObstacleAcker RobotDiff RobotOmni RobotAcker SensorFactory",
    "irsim.world.object_base": "ObjectBase ObjectInfo ObstacleInfo",
    "irsim.world.object_group": "ObjectGroup",
    "irsim.world.map": "Map EnvGridMap FogMap ObstacleMap GridMapGenerator ImageGridGenerator PerlinGridGenerator resolve_obstacle_map build_grid_from_generator",
    "irsim.world.sensors": "Lidar2D FMCWLidar2D SensorFactory Contact2D",
    "irsim.lib": "Behavior GeometryFactory KinematicsFactory KinematicsHandler register_behavior register_behavior_class register_group_behavior register_group_behavior_class register_kinematics generate_polygon random_generate_polygon differential_kinematics ackermann_kinematics omni_kinematics reciprocal_vel_obs social_force_model kinematics_factory GroupBehavior AStarPlanner JPSPlanner RRT RRTStar InformedRRTStar PRMPlanner contact_step SocialForceModelBatch",
    "irsim.lib.behavior": "Behavior register_behavior register_group_behavior",
    "irsim.lib.behavior.behavior_registry": "register_behavior register_behavior_class register_group_behavior register_group_behavior_class behaviors_map behaviors_class_map group_behaviors_map group_behaviors_class_map",
    "irsim.lib.behavior.behavior_methods": "OmniRVO DiffRVO OmniDash DiffDash AckerDash OmniAngularDash SFMVelocity",
    "irsim.lib.algorithm": "differential_kinematics omni_angular_kinematics cast_rays reciprocal_vel_obs social_force_model",
    "irsim.lib.path_planners": "AStarPlanner JPSPlanner RRT RRTStar InformedRRTStar PRMPlanner",
    "irsim.lib.handler.kinematics_handler": "KinematicsHandler KinematicsFactory",
    "irsim.lib.handler.geometry_handler": "GeometryFactory",
    "irsim.util": "WrapToPi WrapToRegion relative_position distance dist_hypot omni_to_diff diff_to_omni transform_point_with_state vertices_transform geometry_transform is_convex_and_ordered gen_inequal_from_vertex cross_product random_point_range file_check find_file is_2d_list time_it time_it2 rng set_seed random_uniform to_numpy",
    "irsim.util.util": "WrapTo2Pi to_numpy traj_to_xy_list points_to_xy_list convert_list_length check_unknown_kwargs validate_shape validate_length ensure_numpy ensure_column_vector get_affine_transform ClipTo2Pi check_number check_choice fit_length find_duplicates find_object_by_identity vel_world2diff vel_diff2world vel_world2omni vel_omni2world",
    "irsim.util.random": "rng set_seed random_uniform",
    "irsim.config": "env_param world_param path_param palette_param",
    "irsim.gui": "MouseControl KeyboardControl",
    "irsim.msg": "Header Point Vector3 Quaternion Pose PoseWithCovariance Twist TwistWithCovariance Odometry LaserScan ContactState ObjectState WorldState",
}
for module, names in NAMES.items():
    try:
        imported = importlib.import_module(module)
    except ImportError as error:
        show(module, type(error).__name__)
        continue
    show(module, [name for name in names.split() if not hasattr(imported, name)])
