"""Where the modules of IR-SIM 2.12 are found today: one table, read by the finder, the stubs and the freezing hooks.

This file imports nothing of irsim, so that a build can read it before there is anything to import.
"""

from __future__ import annotations

__all__ = ["NAMES", "SAME", "old_paths", "submodules"]

SAME: dict[str, str] = {
    "irsim.config": "irsim.env.old.config",
    "irsim.config.env_param": "irsim.env.old.config.env_param",
    "irsim.config.palette_param": "irsim.env.old.config.palette_param",
    "irsim.config.path_param": "irsim.env.old.config.path_param",
    "irsim.config.world_param": "irsim.env.old.config.world_param",
    "irsim.lib.algorithm.generation": "irsim.compat.functions.polygons",
    "irsim.lib.algorithm.kinematics": "irsim.compat.functions.drives",
    "irsim.lib.algorithm.ray_casting_2d": "irsim.compat.functions.ray_casting",
    "irsim.lib.algorithm.rvo": "irsim.compat.functions.rvo",
    "irsim.lib.algorithm.social_force_model": "irsim.compat.functions.social_force",
    "irsim.lib.behavior.behavior": "irsim.compat.handlers.behavior",
    "irsim.lib.behavior.behavior_methods": "irsim.compat.handlers.built_in",
    "irsim.lib.behavior.group_behavior": "irsim.compat.handlers.group_behavior",
    "irsim.lib.behavior.group_behavior_methods": "irsim.compat.handlers.group_built_in",
    "irsim.lib.handler.geometry_handler": "irsim.compat.handlers.geometry",
    "irsim.lib.handler.kinematics_handler": "irsim.compat.handlers.kinematics",
    "irsim.util.angles": "irsim.compat.functions.frames",
    "irsim.util.decorators": "irsim.compat.util.decorators",
    "irsim.util.random": "irsim.compat.util.random",
    "irsim.util.shapes": "irsim.compat.util.shapes",
    "irsim.util.values": "irsim.compat.util.values",
}
"""Old path -> the module that it is another name of."""

NAMES: dict[str, dict[str, str]] = {
    "irsim.env.env_config": {
        "EnvConfig": "irsim.env.old.factory",
    },
    "irsim.env.env_logger": {
        "EnvLogger": "irsim.common.log:Logger",
    },
    "irsim.env.env_plot": {
        "EnvPlot": "irsim.rendering.env_plot",
        "draw_patch": "irsim.graphics.figure.artists",
        "geometry_to_path": "irsim.graphics.figure.artists",
        "linewidth_from_data_units": "irsim.graphics.figure.artists",
        "set_patch_property": "irsim.graphics.figure.artists",
    },
    "irsim.env.env_plot3d": {
        "EnvPlot3D": "irsim.rendering.env_plot3d",
    },
    "irsim.lib": {
        "AStarPlanner": "irsim.compat.planners",
        "Behavior": "irsim.compat.handlers.behavior",
        "GeometryFactory": "irsim.compat.handlers.geometry",
        "GroupBehavior": "irsim.compat.handlers.group_behavior",
        "InformedRRTStar": "irsim.compat.planners",
        "JPSPlanner": "irsim.compat.planners",
        "KinematicsFactory": "irsim.compat.handlers.kinematics",
        "KinematicsHandler": "irsim.components.kinematics._handler",
        "PRMPlanner": "irsim.compat.planners",
        "RRT": "irsim.compat.planners",
        "RRTStar": "irsim.compat.planners",
        "SocialForceModelBatch": "irsim.compat.functions.social_force",
        "ackermann_kinematics": "irsim.compat.functions.drives",
        "contact_step": "irsim.objects.sensors.contact",
        "differential_kinematics": "irsim.compat.functions.drives",
        "generate_polygon": "irsim.compat.functions.polygons",
        "kinematics_factory": "irsim.compat.functions.drives",
        "omni_kinematics": "irsim.compat.functions.drives",
        "random_generate_polygon": "irsim.compat.functions.polygons",
        "reciprocal_vel_obs": "irsim.compat.functions.rvo",
        "register_behavior": "irsim.objects.extensions.registration",
        "register_behavior_class": "irsim.objects.extensions.registration",
        "register_group_behavior": "irsim.objects.extensions.registration",
        "register_group_behavior_class": "irsim.objects.extensions.registration",
        "register_kinematics": "irsim.components.kinematics._handler",
        "social_force_model": "irsim.compat.functions.social_force",
    },
    "irsim.lib.algorithm": {
        "SocialForceModelBatch": "irsim.compat.functions.social_force",
        "ackermann_kinematics": "irsim.compat.functions.drives",
        "cast_rays": "irsim.compat.functions.ray_casting",
        "differential_kinematics": "irsim.compat.functions.drives",
        "generate_polygon": "irsim.compat.functions.polygons",
        "omni_angular_kinematics": "irsim.compat.functions.drives",
        "omni_kinematics": "irsim.compat.functions.drives",
        "random_generate_polygon": "irsim.compat.functions.polygons",
        "reciprocal_vel_obs": "irsim.compat.functions.rvo",
        "social_force_model": "irsim.compat.functions.social_force",
    },
    "irsim.lib.behavior": {
        "Behavior": "irsim.compat.handlers.behavior",
        "register_behavior": "irsim.objects.extensions.registration",
        "register_behavior_class": "irsim.objects.extensions.registration",
        "register_group_behavior": "irsim.objects.extensions.registration",
        "register_group_behavior_class": "irsim.objects.extensions.registration",
    },
    "irsim.lib.behavior.behavior_registry": {
        "behaviors_class_map": "irsim.compat.handlers.behavior_maps",
        "behaviors_map": "irsim.compat.handlers.behavior_maps",
        "group_behaviors_class_map": "irsim.compat.handlers.behavior_maps",
        "group_behaviors_map": "irsim.compat.handlers.behavior_maps",
        "register_behavior": "irsim.objects.extensions.registration",
        "register_behavior_class": "irsim.objects.extensions.registration",
        "register_group_behavior": "irsim.objects.extensions.registration",
        "register_group_behavior_class": "irsim.objects.extensions.registration",
    },
    "irsim.lib.handler": {
        "GeometryFactory": "irsim.compat.handlers.geometry",
        "KinematicsFactory": "irsim.compat.handlers.kinematics",
        "KinematicsHandler": "irsim.compat.handlers.kinematics",
        "register_kinematics": "irsim.compat.handlers.kinematics",
    },
    "irsim.lib.path_planners": {
        "AStarPlanner": "irsim.compat.planners",
        "InformedRRTStar": "irsim.compat.planners",
        "JPSPlanner": "irsim.compat.planners",
        "PRMPlanner": "irsim.compat.planners",
        "RRT": "irsim.compat.planners",
        "RRTStar": "irsim.compat.planners",
    },
    "irsim.lib.path_planners.a_star": {
        "AStarPlanner": "irsim.compat.planners",
    },
    "irsim.lib.path_planners.informed_rrt_star": {
        "InformedRRTStar": "irsim.compat.planners",
    },
    "irsim.lib.path_planners.jps": {
        "JPSPlanner": "irsim.compat.planners",
    },
    "irsim.lib.path_planners.probabilistic_road_map": {
        "PRMPlanner": "irsim.compat.planners",
    },
    "irsim.lib.path_planners.rrt": {
        "RRT": "irsim.compat.planners",
    },
    "irsim.lib.path_planners.rrt_star": {
        "RRTStar": "irsim.compat.planners",
    },
    "irsim.util": {
        "WrapToPi": "irsim.compat.functions.frames",
        "WrapToRegion": "irsim.compat.functions.frames",
        "bind_env": "irsim.compat.util.decorators",
        "cross_product": "irsim.compat.util.shapes",
        "diff_to_omni": "irsim.compat.functions.frames",
        "dist_hypot": "irsim.compat.functions.frames",
        "distance": "irsim.compat.functions.frames",
        "file_check": "irsim.compat.util.values",
        "find_duplicates": "irsim.compat.util.values",
        "find_file": "irsim.compat.util.values",
        "find_object_by_identity": "irsim.compat.util.values",
        "gen_inequal_from_vertex": "irsim.compat.util.shapes",
        "geometry_transform": "irsim.compat.util.shapes",
        "is_2d_list": "irsim.compat.util.values",
        "is_convex_and_ordered": "irsim.compat.util.shapes",
        "normalize_actions": "irsim.compat.util.decorators",
        "omni_to_diff": "irsim.compat.functions.frames",
        "plot_only": "irsim.compat.util.decorators",
        "random_point_range": "irsim.compat.util.shapes",
        "random_uniform": "irsim.compat.util.random",
        "relative_position": "irsim.compat.functions.frames",
        "resolve_message_targets": "irsim.env.messages",
        "rng": "irsim.compat.util.random",
        "set_seed": "irsim.compat.util.random",
        "time_it": "irsim.compat.util.values",
        "time_it2": "irsim.compat.util.values",
        "to_numpy": "irsim.compat.util.values",
        "transform_point_with_state": "irsim.compat.functions.frames",
        "vel_diff2world": "irsim.compat.functions.frames",
        "vel_omni2world": "irsim.compat.functions.frames",
        "vel_world2diff": "irsim.compat.functions.frames",
        "vel_world2omni": "irsim.compat.functions.frames",
        "vertices_transform": "irsim.compat.functions.frames",
    },
    "irsim.util.util": {
        "ClipTo2Pi": "irsim.compat.functions.frames",
        "WrapTo2Pi": "irsim.compat.functions.frames",
        "WrapToPi": "irsim.compat.functions.frames",
        "WrapToRegion": "irsim.compat.functions.frames",
        "check_choice": "irsim.compat.util.values",
        "check_number": "irsim.compat.util.values",
        "check_unknown_kwargs": "irsim.compat.util.values",
        "convert_list_length": "irsim.compat.util.values",
        "convert_list_length_dict": "irsim.compat.util.values",
        "cross_product": "irsim.compat.util.shapes",
        "diff_to_omni": "irsim.compat.functions.frames",
        "dist_hypot": "irsim.compat.functions.frames",
        "distance": "irsim.compat.functions.frames",
        "ensure_column_vector": "irsim.compat.util.decorators",
        "ensure_numpy": "irsim.compat.util.decorators",
        "file_check": "irsim.compat.util.values",
        "find_duplicates": "irsim.compat.util.values",
        "find_file": "irsim.compat.util.values",
        "find_object_by_identity": "irsim.compat.util.values",
        "fit_length": "irsim.compat.util.values",
        "gen_inequal_from_vertex": "irsim.compat.util.shapes",
        "geometry_transform": "irsim.compat.util.shapes",
        "get_affine_transform": "irsim.compat.functions.frames",
        "get_transform": "irsim.compat.functions.frames",
        "is_2d_list": "irsim.compat.util.values",
        "is_convex_and_ordered": "irsim.compat.util.shapes",
        "is_convex_polygon": "irsim.compat.util.shapes",
        "is_list_not_list_of_lists": "irsim.compat.util.values",
        "is_list_of_dicts": "irsim.compat.util.values",
        "is_list_of_lists": "irsim.compat.util.values",
        "is_list_of_numbers": "irsim.compat.util.values",
        "log_error": "irsim.compat.util.values",
        "log_warning": "irsim.compat.util.values",
        "log_warning_once": "irsim.compat.util.values",
        "normalize_actions": "irsim.compat.util.decorators",
        "omni_to_diff": "irsim.compat.functions.frames",
        "pi": "math",
        "points_to_xy_list": "irsim.compat.util.values",
        "random_point_range": "irsim.compat.util.shapes",
        "relative_position": "irsim.compat.functions.frames",
        "rng": "irsim.compat.util.random",
        "time_it": "irsim.compat.util.values",
        "time_it2": "irsim.compat.util.values",
        "to_numpy": "irsim.compat.util.values",
        "traj_to_xy_list": "irsim.compat.util.values",
        "transform_point_with_state": "irsim.compat.functions.frames",
        "validate_length": "irsim.compat.util.decorators",
        "validate_shape": "irsim.compat.util.decorators",
        "vel_diff2world": "irsim.compat.functions.frames",
        "vel_omni2world": "irsim.compat.functions.frames",
        "vel_world2diff": "irsim.compat.functions.frames",
        "vel_world2omni": "irsim.compat.functions.frames",
        "vertices_transform": "irsim.compat.functions.frames",
    },
    "irsim.version": {
        "__version__": "irsim",
    },
    "irsim.world": {
        "ObjectBase": "irsim.env.old.construct",
        "ObjectFactory": "irsim.env.old.factory",
        "ObjectGroup": "irsim.env.old.construct",
        "ObjectStatic": "irsim.env.old.construct",
        "ObstacleAcker": "irsim.env.old.construct",
        "ObstacleDiff": "irsim.env.old.construct",
        "ObstacleMap": "irsim.compat.objects.view",
        "ObstacleOmni": "irsim.env.old.construct",
        "RobotAcker": "irsim.env.old.construct",
        "RobotDiff": "irsim.env.old.construct",
        "RobotOmni": "irsim.env.old.construct",
        "SensorFactory": "irsim.env.old.factory",
        "World": "irsim.env.old.construct",
    },
    "irsim.world.map": {
        "EnvGridMap": "irsim.navigation.map",
        "FogMap": "irsim.simulation.fog",
        "GridMapGenerator": "irsim.components.maps._generators",
        "ImageGridGenerator": "irsim.components.maps._generators",
        "Map": "irsim.navigation.map",
        "ObstacleMap": "irsim.compat.objects.view",
        "PerlinGridGenerator": "irsim.components.maps._generators",
        "build_grid_from_generator": "irsim.components.maps._generators",
        "grid_collision_geometry": "irsim.simulation.occupancy",
        "resolve_obstacle_map": "irsim.components.maps._generators",
    },
    "irsim.world.map.fog_map": {
        "FogMap": "irsim.simulation.fog",
    },
    "irsim.world.map.grid_map_generator_base": {
        "GridMapGenerator": "irsim.components.maps._generators",
    },
    "irsim.world.map.image_map_generator": {
        "ImageGridGenerator": "irsim.components.maps._generators",
    },
    "irsim.world.map.obstacle_map": {
        "ObstacleMap": "irsim.compat.objects.view",
        "grid_collision_geometry": "irsim.simulation.occupancy",
    },
    "irsim.world.map.perlin_map_generator": {
        "PerlinGridGenerator": "irsim.components.maps._generators",
    },
    "irsim.world.object_base": {
        "ObjectBase": "irsim.env.old.construct",
        "ObjectInfo": "irsim.compat.objects.info",
        "ObstacleInfo": "irsim.compat.objects.info",
    },
    "irsim.world.object_factory": {
        "ObjectFactory": "irsim.env.old.factory",
    },
    "irsim.world.object_group": {
        "ObjectGroup": "irsim.env.old.construct",
    },
    "irsim.world.obstacles": {
        "ObjectStatic": "irsim.env.old.construct",
        "ObstacleAcker": "irsim.env.old.construct",
        "ObstacleDiff": "irsim.env.old.construct",
        "ObstacleOmni": "irsim.env.old.construct",
    },
    "irsim.world.obstacles.obstacle_acker": {
        "ObstacleAcker": "irsim.env.old.construct",
    },
    "irsim.world.obstacles.obstacle_diff": {
        "ObstacleDiff": "irsim.env.old.construct",
    },
    "irsim.world.obstacles.obstacle_omni": {
        "ObstacleOmni": "irsim.env.old.construct",
    },
    "irsim.world.obstacles.obstacle_static": {
        "ObjectStatic": "irsim.env.old.construct",
    },
    "irsim.world.robots": {
        "RobotAcker": "irsim.env.old.construct",
        "RobotDiff": "irsim.env.old.construct",
        "RobotOmni": "irsim.env.old.construct",
    },
    "irsim.world.robots.robot_acker": {
        "RobotAcker": "irsim.env.old.construct",
    },
    "irsim.world.robots.robot_diff": {
        "RobotDiff": "irsim.env.old.construct",
    },
    "irsim.world.robots.robot_omni": {
        "RobotOmni": "irsim.env.old.construct",
    },
    "irsim.world.sensors": {
        "Contact2D": "irsim.objects.sensors.contact",
        "FMCWLidar2D": "irsim.objects.sensors.lidar",
        "Lidar2D": "irsim.objects.sensors.lidar",
        "SensorFactory": "irsim.env.old.factory",
    },
    "irsim.world.sensors.contact2d": {
        "Contact2D": "irsim.objects.sensors.contact",
    },
    "irsim.world.sensors.fmcw_lidar2d": {
        "FMCWLidar2D": "irsim.objects.sensors.lidar",
    },
    "irsim.world.sensors.lidar2d": {
        "Lidar2D": "irsim.objects.sensors.lidar",
    },
    "irsim.world.sensors.sensor_factory": {
        "SensorFactory": "irsim.env.old.factory",
    },
    "irsim.world.world": {
        "World": "irsim.env.old.construct",
    },
    "irsim.world.world3d": {
        "World3D": "irsim.env.old.env_base3d",
    },
}
"""Old path of a module that only re-exports -> each of its names -> the module that has it (``module:name`` there)."""


def old_paths() -> list[str]:
    """Every module path of 2.12 that the finder answers for, sorted."""
    return sorted({*SAME, *NAMES})


def submodules(package: str) -> list[str]:
    """Names of the old modules directly below an old path, sorted; without any, the path is not a package."""
    return sorted(path.rpartition(".")[2] for path in old_paths() if path.rpartition(".")[0] == package)
