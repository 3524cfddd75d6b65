"""Modules of 2.12 that scripts import from, and what the class maps list."""

import subprocess
import sys
from importlib import import_module

import numpy as np
import pytest

from irsim.diagnostics.errors import ScenarioError
from irsim.world import World

PATHS = """
irsim.gui.mouse_control:MouseControl irsim.gui.keyboard_control:KeyboardControl irsim.version:__version__
irsim.world.sensors.lidar2d:Lidar2D irsim.world.sensors.fmcw_lidar2d:FMCWLidar2D
irsim.world.sensors.contact2d:Contact2D irsim.world.sensors.sensor_factory:SensorFactory
irsim.world.robots.robot_acker:RobotAcker irsim.world.robots.robot_diff:RobotDiff
irsim.world.robots.robot_omni:RobotOmni irsim.world.robots:RobotDiff irsim.world.obstacles:ObjectStatic
irsim.world.obstacles.obstacle_acker:ObstacleAcker irsim.world.obstacles.obstacle_diff:ObstacleDiff
irsim.world.obstacles.obstacle_omni:ObstacleOmni irsim.world.obstacles.obstacle_static:ObjectStatic
irsim.world.map.fog_map:FogMap irsim.world.map.obstacle_map:ObstacleMap
irsim.world.map.grid_map_generator_base:GridMapGenerator irsim.world.map.image_map_generator:ImageGridGenerator
irsim.world.map.perlin_map_generator:PerlinGridGenerator
irsim:__version__ irsim.env.env_base:EnvBase irsim.env.env_config:EnvConfig irsim.env.env_logger:EnvLogger
irsim.env.env_plot:EnvPlot irsim.env.env_plot:draw_patch irsim.env.env_plot:set_patch_property
irsim.env.env_plot:linewidth_from_data_units irsim.env.env_plot:geometry_to_path irsim.env.env_plot3d:EnvPlot3D
irsim.world.object_base:ObjectBase irsim.world.object_base:ObjectInfo irsim.world.object_base:ObstacleInfo
irsim.world.object_group:ObjectGroup irsim.world.object_factory:ObjectFactory irsim.util.util:normalize_actions
irsim.config:env_param irsim.config:world_param irsim.config:path_param irsim.config:palette_param
irsim.lib.behavior.group_behavior:GroupBehavior irsim.lib.behavior.group_behavior_methods:OrcaGroupBehavior
irsim.lib.behavior.group_behavior_methods:SfmGroupBehavior irsim.lib.behavior.group_behavior_methods:beh_omni_orca
irsim.lib.algorithm:cast_rays irsim.lib.algorithm:omni_angular_kinematics irsim.lib.algorithm:reciprocal_vel_obs
irsim.lib.algorithm:social_force_model irsim.lib.algorithm.rvo:reciprocal_vel_obs
irsim.lib.handler.kinematics_handler:KinematicsFactory irsim.lib.handler.kinematics_handler:OmniKinematics
irsim.lib.handler.kinematics_handler:register_kinematics irsim.lib.handler.geometry_handler:GeometryFactory
irsim.lib.handler.geometry_handler:geometry_handler irsim.lib.handler.geometry_handler:CircleGeometry
"""


@pytest.mark.parametrize("path", PATHS.split())
def test_the_module_is_there_and_gives_the_same_class(path):
    module, _, name = path.partition(":")
    package = ".".join(module.split(".")[:2])
    imported = getattr(import_module(module), name)
    assert imported is getattr(import_module(package), name, imported)


def listed(statement: str) -> str:
    code = f"import irsim.lib.behavior.behavior_registry as r\n{statement}"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_the_maps_of_behaviors_list_the_built_in_ones():
    printed = listed(
        "print(len(r.behaviors_map), ('diff', 'rvo') in r.behaviors_map)\n"
        "print(sorted(r.group_behaviors_class_map)[:2], len(r.group_behaviors_class_map))\n"
        "print(len(r.behaviors_class_map), len(r.group_behaviors_map))"
    )
    assert printed.splitlines() == ["8 True", "[('diff', 'orca'), ('diff', 'sfm')] 4", "0 0"]
    assert listed("from irsim.lib.behavior.behavior_registry import behaviors_map as b; print(len(b))") == "8"


def test_a_world_takes_its_arguments_by_place():
    world = World("w", 8, 10, 0.2)
    assert (world.name, world.height, world.width, world.step_time) == ("w", 8, 10, 0.2)
    assert World().grid_map is None
    with pytest.raises(ScenarioError, match="step_tim"):
        World(step_tim=0.1)


def test_a_world_takes_an_array_as_its_map():
    values = np.eye(4) * 100
    world = World("w", 4, 6, obstacle_map=values)
    assert (world.grid_map == values).all()
    assert world.reso.ravel().tolist() == [1.5, 1.0]
    assert world.obstacle_positions.shape == (2, 4)
