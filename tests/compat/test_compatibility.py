"""The published list of differences: complete, and the one that the tests read."""

import re

import pytest

import irsim
from irsim.compat import DIFFERENCES, KEY_DIFFERENCES, NAME_DIFFERENCES, missing_names, reference_names
from irsim.compat.absent import ABSENT
from irsim.lookup import lookup
from tests.compat.scripts import SCRIPTS
from tests.parity import test_parity as of_traces

_IDS = re.compile(r"[\w-]+")


def test_traces_name_published_ids() -> None:
    assert set(of_traces.DIFFERENCES) <= set(DIFFERENCES)


@pytest.mark.parametrize("table", [KEY_DIFFERENCES, NAME_DIFFERENCES])
def test_ids_that_are_named_exist(table: dict[str, str]) -> None:
    assert {name for ids in table.values() for name in _IDS.findall(ids)} <= set(DIFFERENCES)


def test_names_that_differ_exist() -> None:
    owners = {place.partition(":")[2]: names for place, names in reference_names().items()}
    for place in NAME_DIFFERENCES:
        owner, _, name = place.rpartition(".")
        assert name in owners[owner], place


def test_public_names_of_2_12_are_here_or_have_a_reason_and_no_others_have_one() -> None:
    missing = missing_names()
    assert [name for name in missing if name not in ABSENT and name.partition(".")[0] not in ABSENT] == []
    assert set(ABSENT) <= set(missing)


def test_objects_of_an_environment_have_every_public_name() -> None:
    env = irsim.make(str(SCRIPTS / "sensors.yaml"), display=False, log_level="ERROR")
    mapped = irsim.make(str(SCRIPTS / "perlin_map.yaml"), display=False, log_level="ERROR")
    message, robot = env.get_msg(), env.robot
    instances = {
        "irsim.env:EnvBase": env,
        "irsim.env.env_config:EnvConfig": env.env_config,
        "irsim.env.env_plot:EnvPlot": env._env_plot,
        "irsim.env.env_logger:EnvLogger": env.logger,
        "irsim.world:World": env._world,
        "irsim.world:ObjectBase": robot,
        "irsim.world:ObjectFactory": env.object_factory,
        "irsim.world:ObstacleMap": next(o for o in mapped.obstacle_list if o.shape == "map"),
        "irsim.world.object_base:ObjectInfo": robot.info,
        "irsim.world.object_base:ObstacleInfo": env.obstacle_list[0].get_obstacle_info(),
        "irsim.world.map:Map": mapped.get_map(0),
        "irsim.world.sensors:Lidar2D": robot.lidar,
        "irsim.world.sensors:Contact2D": robot.contact,
        "irsim.gui:MouseControl": env.mouse,
        "irsim.gui:KeyboardControl": env.keyboard,
        "irsim.msg:WorldState": message,
        "irsim.msg:ObjectState": message.robots[0],
        "irsim.msg:Odometry": message.robots[0].odom,
        "irsim.msg:LaserScan": message.robots[0].scan,
    }
    lacking = [
        f"{place}.{name}"
        for place, instance in instances.items()
        for name in reference_names()[place]
        if not hasattr(instance, name) and f"{place}.{name}" not in ABSENT
    ]
    env.end(0)
    mapped.end(0)
    assert lacking == []


def test_ids_can_be_looked_up() -> None:
    assert lookup("D6").text.startswith("IR-SIM 2.12: polygons and maps")
