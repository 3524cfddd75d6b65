"""Contacts as scripts see them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
import irsim.lib as irsim_lib
from irsim.contacts import contact_step
from irsim.env import Env
from irsim.world.sensors import Contact2D

WORLD = """
world: {width: 10, height: 10, collision_mode: contact, gravity: 10.0}
robot:
  - kinematics: {name: diff, tau: 0.2}
    shape: {name: circle, radius: 0.2}
    state: [1, 5, 0]
    mass: 2
    friction: 1
    velocity: [1, 0]
    sensors: [{name: contact2d, force_scale: 0.1}]
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 2, 0]}
obstacle:
  - {shape: {name: rectangle, length: 0.4, width: 0.4}, state: [1.45, 5, 0], mass: 1.5, restitution: 0.0}
  - {shape: {name: circle, radius: 0.2}, state: [8, 8, 0]}
"""


@pytest.fixture
def env(tmp_path: Path) -> Any:
    path = tmp_path / "world.yaml"
    path.write_text(WORLD)
    made = irsim.make(str(path), headless=True, log_level="ERROR")
    yield made
    made.end()


def test_physics_of_objects(env: Env) -> None:
    robot, _, box, rock = env.objects
    assert (robot.pushable, robot.passive, robot.static) == (True, False, False)
    assert (box.pushable, box.passive, box.static) == (True, True, False)
    assert (rock.pushable, rock.passive, rock.static) == (False, True, True)
    assert (robot.mass, robot.friction, robot.drive_tau) == (2, 1, 0.2)
    assert robot.inertia == pytest.approx(2 * 0.2**2 / 2)
    assert box.inertia == pytest.approx(1.5 * (0.4**2 + 0.4**2) / 12)
    assert box.gyration == pytest.approx(np.sqrt(box.inertia / 1.5))
    assert (box.inv_mass, box.inv_inertia) == pytest.approx((1 / 1.5, 1 / box.inertia))
    assert (rock.inv_mass, rock.inv_inertia, rock.gyration) == (0, 0, 0)
    assert (rock.mass, rock.inertia, rock.friction_force) == (np.inf, np.inf, np.inf)
    assert robot.friction_force == pytest.approx(20.0)
    assert robot.drive_velocity_xy.tolist() == [[1.0], [0.0]]
    assert robot.info.mass == 2
    assert box.info.inertia == pytest.approx(box.inertia)
    assert box.color == "#E69F00"


def test_records_of_the_last_step(env: Env) -> None:
    robot, other, box, _ = env.objects
    assert env.contacts == []
    assert not robot.contact.in_contact
    env.step([1.0, 0.0])
    (contact,) = env.contacts
    assert (contact.a, contact.b) == (robot, box)
    assert contact.normal.tolist() == [-1, 0]
    (felt,) = robot.contact.reports
    assert felt.other is box
    assert felt.normal.tolist() == [-1, 0]
    assert box.contact.reports[0].normal.tolist() == [1, 0]
    assert robot.contact.force[0, 0] == pytest.approx(-contact.force)
    assert box.contact.force[0, 0] == pytest.approx(contact.force)
    assert robot.contact.partners == [box]
    assert (robot.contact.started, robot.contact.ended) == (True, False)
    assert robot.contact.contact_time == pytest.approx(0.1)
    assert other.contact.air_time == pytest.approx(0.1)
    assert env.status == "Running"
    assert not robot.collision
    assert isinstance(robot.contact, Contact2D)
    assert robot.sensors == [robot.contact]
    assert robot.lidar is None


def test_hooks_of_the_solver(env: Env) -> None:
    robot, _, box, _ = env.objects
    box.apply_contact_displacement(np.array([[0.1], [0.0]]), 0.2)
    assert box.state[:, 0].tolist() == pytest.approx([1.55, 5, 0.2])
    assert box.velocity[:, 0].tolist() == pytest.approx([1, 0, 2])
    box.apply_contact_velocity([0.0, 0.5])
    assert box.velocity[:, 0].tolist() == pytest.approx([1, 0.5, 2])
    robot.apply_contact_velocity([-0.25, 0.5])
    assert robot.velocity[:, 0].tolist() == pytest.approx([0.75, 0])


def test_contact_step(env: Env) -> None:
    robot, _, box, rock = env.objects
    robot.set_state([1.2, 5, 0])
    (contact,) = irsim_lib.contact_step([(robot, box)], step_time=0.1)
    assert (contact.a, contact.b) == (robot, box)
    assert box.state[0, 0] == pytest.approx(1.6, abs=2e-6)
    assert contact_step([]) == []
    assert contact_step([(box, rock)]) == []


def test_what_is_drawn(env: Env) -> None:
    from irsim.render.builder import SceneBuilder

    env.step([1.0, 0.0])
    scene = SceneBuilder(env.simulation).build()
    (force,) = scene.of(0, "contact")
    x, y = env.contacts[0].point
    length = env.contacts[0].force * 0.1
    points: Any = force.geometry.points  # type: ignore[union-attr]
    assert points == pytest.approx(np.array([[x, y], [x - length, y]]))
    assert list(scene.of(2, "contact")) == []
