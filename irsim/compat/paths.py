"""Where the modules of IR-SIM 2.12 are found today: one table, read by the finder, the stubs and the freezing hooks.

This file imports nothing of irsim: ``python irsim/compat/paths.py FOLDER`` writes the stub package ``irsim-stubs``,
through which type checkers and editors see the old paths, when a package is built and cannot be imported yet.
"""

from __future__ import annotations

import sys
from pathlib import Path

__all__ = ["NAMES", "SAME", "old_paths", "stub_files", "submodules"]

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
    "irsim.lib.behavior.group_behavior": "irsim.compat.handlers.behavior",
    "irsim.lib.behavior.group_behavior_methods": "irsim.compat.handlers.built_in",
    "irsim.lib.handler.geometry_handler": "irsim.compat.handlers.geometry",
    "irsim.lib.handler.kinematics_handler": "irsim.compat.handlers.kinematics",
    "irsim.util.angles": "irsim.compat.functions.frames",
    "irsim.util.decorators": "irsim.compat.util.decorators",
    "irsim.util.random": "irsim.compat.util.random",
    "irsim.util.shapes": "irsim.compat.util.shapes",
    "irsim.util.values": "irsim.compat.util.values",
}
"""Old path -> the module that it is another name of."""

_NAMES_BY_HOME: dict[str, dict[str, str]] = {
    "irsim.env.env_base3d": {"irsim.env.old.env_base3d": "EnvBase3D World3D"},
    "irsim.env.env_config": {"irsim.env.old.factory": "EnvConfig"},
    "irsim.env.env_logger": {"irsim.common.log:Logger": "EnvLogger"},
    "irsim.env.env_plot": {
        "irsim.env.old.env_plot": "EnvPlot",
        "irsim.graphics.figure.artists": "draw_patch geometry_to_path linewidth_from_data_units set_patch_property",
    },
    "irsim.env.env_plot3d": {"irsim.env.old.env_plot3d": "EnvPlot3D"},
    "irsim.lib": {
        "irsim.compat.planners": "AStarPlanner InformedRRTStar JPSPlanner PRMPlanner RRT RRTStar",
        "irsim.compat.handlers.behavior": "Behavior GroupBehavior",
        "irsim.compat.handlers.geometry": "GeometryFactory",
        "irsim.compat.handlers.kinematics": "KinematicsFactory",
        "irsim.components.kinematics._handler": "KinematicsHandler register_kinematics",
        "irsim.compat.functions.social_force": "SocialForceModelBatch social_force_model",
        "irsim.compat.functions.drives": """
            ackermann_kinematics differential_kinematics kinematics_factory omni_kinematics
        """,
        "irsim.objects.sensors.contact": "contact_step",
        "irsim.compat.functions.polygons": "generate_polygon random_generate_polygon",
        "irsim.compat.functions.rvo": "reciprocal_vel_obs",
        "irsim.objects.extensions.registration": """
            register_behavior register_behavior_class register_group_behavior register_group_behavior_class
        """,
    },
    "irsim.lib.algorithm": {
        "irsim.compat.functions.social_force": "SocialForceModelBatch social_force_model",
        "irsim.compat.functions.drives": """
            ackermann_kinematics differential_kinematics omni_angular_kinematics omni_kinematics
        """,
        "irsim.compat.functions.ray_casting": "cast_rays",
        "irsim.compat.functions.polygons": "generate_polygon random_generate_polygon",
        "irsim.compat.functions.rvo": "reciprocal_vel_obs",
    },
    "irsim.lib.behavior": {
        "irsim.compat.handlers.behavior": "Behavior",
        "irsim.objects.extensions.registration": """
            register_behavior register_behavior_class register_group_behavior register_group_behavior_class
        """,
    },
    "irsim.lib.behavior.behavior_registry": {
        "irsim.compat.handlers.behavior": """
            behaviors_class_map behaviors_map group_behaviors_class_map group_behaviors_map
        """,
        "irsim.objects.extensions.registration": """
            register_behavior register_behavior_class register_group_behavior register_group_behavior_class
        """,
    },
    "irsim.lib.handler": {
        "irsim.compat.handlers.geometry": "GeometryFactory",
        "irsim.compat.handlers.kinematics": "KinematicsFactory KinematicsHandler register_kinematics",
    },
    "irsim.lib.path_planners": {
        "irsim.compat.planners": "AStarPlanner InformedRRTStar JPSPlanner PRMPlanner RRT RRTStar",
    },
    "irsim.lib.path_planners.a_star": {"irsim.compat.planners": "AStarPlanner"},
    "irsim.lib.path_planners.informed_rrt_star": {"irsim.compat.planners": "InformedRRTStar"},
    "irsim.lib.path_planners.jps": {"irsim.compat.planners": "JPSPlanner"},
    "irsim.lib.path_planners.probabilistic_road_map": {"irsim.compat.planners": "PRMPlanner"},
    "irsim.lib.path_planners.rrt": {"irsim.compat.planners": "RRT"},
    "irsim.lib.path_planners.rrt_star": {"irsim.compat.planners": "RRTStar"},
    "irsim.util": {
        "irsim.compat.functions.frames": """
            WrapToPi WrapToRegion diff_to_omni dist_hypot distance omni_to_diff relative_position
            transform_point_with_state vel_diff2world vel_omni2world vel_world2diff vel_world2omni vertices_transform
        """,
        "irsim.compat.util.decorators": "bind_env normalize_actions plot_only",
        "irsim.compat.util.shapes": """
            cross_product gen_inequal_from_vertex geometry_transform is_convex_and_ordered random_point_range
        """,
        "irsim.compat.util.values": """
            file_check find_duplicates find_file find_object_by_identity is_2d_list time_it time_it2 to_numpy
        """,
        "irsim.compat.util.random": "random_uniform rng set_seed",
        "irsim.env.messages": "resolve_message_targets",
    },
    "irsim.util.util": {
        "irsim.compat.functions.frames": """
            ClipTo2Pi WrapTo2Pi WrapToPi WrapToRegion diff_to_omni dist_hypot distance get_affine_transform
            get_transform omni_to_diff relative_position transform_point_with_state vel_diff2world vel_omni2world
            vel_world2diff vel_world2omni vertices_transform
        """,
        "irsim.compat.util.values": """
            check_choice check_number check_unknown_kwargs convert_list_length convert_list_length_dict file_check
            find_duplicates find_file find_object_by_identity fit_length is_2d_list is_list_not_list_of_lists
            is_list_of_dicts is_list_of_lists is_list_of_numbers log_error log_warning log_warning_once
            points_to_xy_list time_it time_it2 to_numpy traj_to_xy_list
        """,
        "irsim.compat.util.shapes": """
            cross_product gen_inequal_from_vertex geometry_transform is_convex_and_ordered is_convex_polygon
            random_point_range
        """,
        "irsim.compat.util.decorators": """
            ensure_column_vector ensure_numpy normalize_actions validate_length validate_shape
        """,
        "math": "pi",
        "irsim.compat.util.random": "rng",
    },
    "irsim.version": {"irsim": "__version__"},
    "irsim.world": {
        "irsim.env.old.construct": """
            ObjectBase ObjectGroup ObjectStatic ObstacleAcker ObstacleDiff ObstacleOmni RobotAcker RobotDiff
            RobotOmni World
        """,
        "irsim.env.old.factory": "ObjectFactory SensorFactory",
        "irsim.compat.objects.view": "ObstacleMap",
    },
    "irsim.world.map": {
        "irsim.navigation.map": "EnvGridMap Map",
        "irsim.simulation.fog": "FogMap",
        "irsim.components.maps._generators": """
            GridMapGenerator ImageGridGenerator PerlinGridGenerator build_grid_from_generator resolve_obstacle_map
        """,
        "irsim.compat.objects.view": "ObstacleMap",
        "irsim.simulation.occupancy": "grid_collision_geometry",
    },
    "irsim.world.map.fog_map": {"irsim.simulation.fog": "FogMap"},
    "irsim.world.map.grid_map_generator_base": {"irsim.components.maps._generators": "GridMapGenerator"},
    "irsim.world.map.image_map_generator": {"irsim.components.maps._generators": "ImageGridGenerator"},
    "irsim.world.map.obstacle_map": {
        "irsim.compat.objects.view": "ObstacleMap",
        "irsim.simulation.occupancy": "grid_collision_geometry",
    },
    "irsim.world.map.perlin_map_generator": {"irsim.components.maps._generators": "PerlinGridGenerator"},
    "irsim.world.object_base": {
        "irsim.env.old.construct": "ObjectBase",
        "irsim.compat.objects.info": "ObjectInfo ObstacleInfo",
    },
    "irsim.world.object_factory": {"irsim.env.old.factory": "ObjectFactory"},
    "irsim.world.object_group": {"irsim.env.old.construct": "ObjectGroup"},
    "irsim.world.obstacles": {"irsim.env.old.construct": "ObjectStatic ObstacleAcker ObstacleDiff ObstacleOmni"},
    "irsim.world.obstacles.obstacle_acker": {"irsim.env.old.construct": "ObstacleAcker"},
    "irsim.world.obstacles.obstacle_diff": {"irsim.env.old.construct": "ObstacleDiff"},
    "irsim.world.obstacles.obstacle_omni": {"irsim.env.old.construct": "ObstacleOmni"},
    "irsim.world.obstacles.obstacle_static": {"irsim.env.old.construct": "ObjectStatic"},
    "irsim.world.robots": {"irsim.env.old.construct": "RobotAcker RobotDiff RobotOmni"},
    "irsim.world.robots.robot_acker": {"irsim.env.old.construct": "RobotAcker"},
    "irsim.world.robots.robot_diff": {"irsim.env.old.construct": "RobotDiff"},
    "irsim.world.robots.robot_omni": {"irsim.env.old.construct": "RobotOmni"},
    "irsim.world.sensors": {
        "irsim.objects.sensors.contact": "Contact2D",
        "irsim.objects.sensors.lidar": "FMCWLidar2D Lidar2D",
        "irsim.env.old.factory": "SensorFactory",
    },
    "irsim.world.sensors.contact2d": {"irsim.objects.sensors.contact": "Contact2D"},
    "irsim.world.sensors.fmcw_lidar2d": {"irsim.objects.sensors.lidar": "FMCWLidar2D"},
    "irsim.world.sensors.lidar2d": {"irsim.objects.sensors.lidar": "Lidar2D"},
    "irsim.world.sensors.sensor_factory": {"irsim.env.old.factory": "SensorFactory"},
    "irsim.world.world": {"irsim.env.old.construct": "World"},
    "irsim.world.world3d": {"irsim.env.old.env_base3d": "World3D"},
}
"""Old path of a module that only re-exports -> a module of today (``module:name`` for another name) -> names."""

NAMES: dict[str, dict[str, str]] = {
    path: {name: home for home, names in homes.items() for name in names.split()}
    for path, homes in _NAMES_BY_HOME.items()
}
"""Old path of a module that only re-exports -> each of its names -> the module that has it (``module:name`` there)."""


def old_paths() -> list[str]:
    """Every module path of 2.12 that the finder answers for, sorted."""
    return sorted({*SAME, *NAMES})


def submodules(package: str) -> list[str]:
    """Names of the old modules directly below an old path, sorted; without any, the path is not a package."""
    return sorted(path.rpartition(".")[2] for path in old_paths() if path.rpartition(".")[0] == package)


def stub_files() -> dict[str, str]:
    """Path below ``irsim-stubs`` -> text of every stub."""
    files = {"py.typed": "partial\n"}
    for path in old_paths():
        file = path.removeprefix("irsim.").replace(".", "/") + ("/__init__.pyi" if submodules(path) else ".pyi")
        if path in SAME:
            files[file] = f"from {SAME[path]} import *\n"
        else:
            files[file] = "".join(_import(name, home) for name, home in sorted(NAMES[path].items()))
    return files


def _import(name: str, home: str) -> str:
    module, _, name_there = home.partition(":")
    return f"from {module} import {name_there or name} as {name}\n"


if __name__ == "__main__":
    for file, text in stub_files().items():
        path = Path(sys.argv[1], file)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
