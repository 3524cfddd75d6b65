"""Contacts as scripts see them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim.lib as irsim_lib
from irsim.env import Env
from irsim.objects.sensors.contact import contact_step
from irsim.simulation.simulation import Simulation
from irsim.world.sensors import Contact2D
from tests.env.driving import Make, take_steps

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
def env(make: Make) -> Env:
    return make(WORLD)


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
    assert (robot.friction_force, robot.drive_velocity_xy.tolist()) == (pytest.approx(20.0), [[1.0], [0.0]])
    assert robot.info.mass == 2
    assert box.info.inertia == pytest.approx(box.inertia)
    assert box.color == "#E69F00"


def test_records_of_the_last_step(env: Env) -> None:
    robot, other, box, _ = env.objects
    assert env.contacts == []
    assert not robot.contact.in_contact
    env.step([1.0, 0.0])
    (contact,) = env.contacts
    assert (contact.a, contact.b, contact.normal.tolist()) == (robot, box, [-1, 0])
    (felt,) = robot.contact.reports
    assert felt.other is box
    assert felt.normal.tolist() == [-1, 0]
    assert box.contact.reports[0].normal.tolist() == [1, 0]
    assert robot.contact.force[0, 0] == pytest.approx(-contact.force)
    assert box.contact.force[0, 0] == pytest.approx(contact.force)
    assert (robot.contact.partners, robot.contact.started, robot.contact.ended) == ([box], True, False)
    assert robot.contact.contact_time == pytest.approx(0.1)
    assert other.contact.air_time == pytest.approx(0.1)
    assert env.status == "Running"
    assert not robot.collision
    assert isinstance(robot.contact, Contact2D)
    assert (robot.sensors, robot.lidar) == ([robot.contact], None)


def test_hooks_of_the_solver(env: Env) -> None:
    robot, _, box, _ = env.objects
    box.apply_contact_displacement(np.array([[0.1], [0.0]]), 0.2)
    box.apply_contact_velocity([0.0, 0.5])
    assert box.state[:, 0].tolist() == pytest.approx([1.55, 5, 0.2])
    assert box.velocity[:, 0].tolist() == pytest.approx([1, 0.5, 2])
    robot.apply_contact_velocity([-0.25, 0.5])
    assert robot.velocity[:, 0].tolist() == pytest.approx([0.75, 0])


def test_contact_step(env: Env) -> None:
    robot, _, box, rock = env.objects
    robot.set_state([1.2, 5, 0])
    (contact,) = irsim_lib.contact_step([(robot, box)], step_time=0.1)
    assert (contact.a, contact.b, box.state[0, 0]) == (robot, box, pytest.approx(1.6, abs=2e-6))
    assert contact_step([]) == contact_step([(box, rock)]) == []


def test_what_is_drawn(env: Env) -> None:
    from irsim.objects.drawing.scene_builder import SceneBuilder

    env.step([1.0, 0.0])
    scene = SceneBuilder(env.simulation).build()
    (force,) = scene.of(0, "contact")
    x, y = env.contacts[0].point
    length = env.contacts[0].force * 0.1
    points: Any = force.geometry.points  # type: ignore[union-attr]
    assert points == pytest.approx(np.array([[x, y], [x - length, y]]))
    assert list(scene.of(2, "contact")) == []


def test_compounds_turn_about_the_centre_of_what_they_cover(make: Make) -> None:
    def body(*rectangles: tuple[float, ...]) -> dict[str, Any]:
        parts = [{"name": "rectangle", "length": a, "width": b, "pose": [x, y, 0]} for a, b, x, y in rectangles]
        return {"shape": {"name": "compound", "parts": parts}, "state": [5, 5, 0.3], "mass": 4}

    ell = [(1.0, 0.2, 0.5, 0.1), (0.2, 0.6, 0.1, 0.5)]  # side by side
    overlapping = [(1.0, 0.2, 0.5, 0.1), (0.2, 0.8, 0.1, 0.4)]  # the same area, a corner twice
    apart = [(0.4, 0.2, 0.0, 0.0), (0.4, 0.2, 1.0, 0.0)]
    bodies = [body(*ell), body(*overlapping), body(*apart)]
    env = make(
        f"world: {{collision_mode: contact}}\nrobot: {{kinematics: {{name: diff}}, state: [1, 1, 0]}}\n"
        f"obstacle: {bodies}"
    )
    area = np.array([a * b for a, b, _, _ in ell])
    centre = np.array([[x, y] for _, _, x, y in ell])
    whole = area @ centre / area.sum()
    own = np.array([(a**2 + b**2) / 12 for a, b, _, _ in ell])
    steiner = np.sum((centre - whole) ** 2, axis=1)
    inertia = 4 * float(area @ (own + steiner)) / area.sum()
    for view in env.obstacle_list[:2]:
        w, i, _, x, y = env.simulation.state.body(view.row)
        assert (x, y) == pytest.approx(tuple(whole), abs=1e-12)
        assert (w, i, view.inertia) == pytest.approx((1 / 4, 1 / inertia, inertia), abs=1e-9)
    loose = env.obstacle_list[2]
    assert loose.inertia == pytest.approx(4 * loose.radius**2 / 2), "in pieces: as a disc around all of them"
    assert env.simulation.state.body(loose.row)[3:] == pytest.approx((0.5, 0.0))


def test_actions_and_behaviors_meet_the_same_grip(make: Make) -> None:
    text = """
world: {collision_mode: contact, width: 20, height: 20}
robot: {kinematics: {name: diff, tau: 0.2}, state: [1, 5, 0], goal: [15, 5, 0], friction: 0.2, mass: 3, %s}
obstacle: [{shape: {name: circle, radius: 0.3}, state: [1.8, 5.05, 0], mass: 1}]
"""
    led, told = make(text % "behavior: {name: dash}"), make(text % "behavior: null")
    for step in range(30):
        heading = float(led.robot.state[2, 0])
        bearing = float(np.arctan2(*(led.robot.goal[:2, 0] - led.robot.state[:2, 0])[::-1]))
        error = (bearing - heading + np.pi) % (2 * np.pi) - np.pi
        led.step()
        assert abs(error) <= 0.1, f"dash turns at step {step}"
        told.step([float(np.cos(error)), 0.0])
        for a, b in zip(led.objects, told.objects, strict=True):
            assert a.state == pytest.approx(b.state, abs=1e-9)
    assert led.objects[1].state[0, 0] > 2.5


def test_objects_come_and_go_and_reset_brings_all_back(env: Env) -> None:
    robot, other, box, _ = env.objects
    start = [view.state.copy() for view in (robot, other)]
    take_steps(env, 3, [1.0, 0.0])
    assert env.contacts
    speed = robot.velocity.copy()
    env.delete_object(box.id)
    assert env.contacts == []
    assert robot.velocity.tolist() == speed.tolist(), "what the drive does goes on"
    env.step([1.0, 0.0])
    assert env.contacts == []
    new = env.create_obstacle(shape={"name": "circle", "radius": 0.2}, state=[2.0, 5, 0], mass=0.5, static=False)
    env.add_object(new)
    partners = set()
    for _ in range(10):
        env.step([1.0, 0.0])
        partners |= {view for contact in env.contacts for view in (contact.a, contact.b)}
    assert new in partners
    assert new.state[0, 0] > 2.05
    assert new.pushable
    assert float(np.hypot(*(new.state[:2, 0] - robot.state[:2, 0]))) >= 0.4 - 1e-3
    env.delete_object(new.id)
    env.add_object(box)
    env.step([1.0, 0.0])
    env.reset()
    assert [view.state for view in (robot, other)] == [pytest.approx(state) for state in start]
    assert (env.contacts, robot.contact.contact_time) == ([], 0)


def test_worlds_of_a_batch_are_single_worlds(env: Env) -> None:
    many = Simulation(env.scenario, [3, 4, 5], threads=2)
    n = many.objects
    for _ in range(20):
        for w in range(3):
            many.impose(w * n, [0.5 + 0.2 * w, 0.1])
        many.step()
    for w, seed in enumerate([3, 4, 5]):
        one = Simulation(env.scenario, [seed])
        for _ in range(20):
            one.impose(0, [0.5 + 0.2 * w, 0.1])
            one.step()
        for name in ("pose", "control", "twist"):
            assert getattr(many, name)[w * n : (w + 1) * n].tobytes() == getattr(one, name).tobytes()
        assert many.state.contacts(w) == one.state.contacts(0)


@pytest.mark.parametrize("rows", [2, 5])
@pytest.mark.parametrize("mass", [40.0, 5.0])
def test_a_squeeze_leaves_nobody_inside_another(make: Make, rows: int, mass: float) -> None:
    places = [[3.0 + 0.41 * column, 3.2 + 0.41 * row, 0.0] for column in range(4) for row in range(rows)]
    drivers = [[2.0, 3.2 + 0.41 * row, 0.0] for row in range(3)]
    env = make(f"""
world: {{width: 14, height: 14, step_time: 0.1, collision_mode: contact}}
robot: {{number: 3, state: {drivers}, goal: [[12, 3.2], [12, 3.6], [12, 4]], mass: {mass}, friction: 1.0,
  kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, behavior: {{name: dash}}}}
obstacle:
  - {{number: {len(places)}, state: {places}, mass: 1.0, friction: 0.4, shape: {{name: circle, radius: 0.2}}}}
  - {{shape: {{name: rectangle, length: 0.2, width: 8}}, state: [5.2, 3.6, 0]}}
""")
    discs = [item for item in env.objects if item.shape == "circle"]
    touched = 0
    for _ in range(45):
        env.step()
        centers = np.array([item.state[:2, 0] for item in discs])
        gaps = np.linalg.norm(centers[:, None] - centers[None], axis=2) - 0.4 + 10 * np.eye(len(discs))
        touched += bool(gaps.min() < 1e-3)
        assert gaps.min() > -1e-3
        assert centers[:, 0].max() < 5.1 - 0.2 + 1e-3  # nor in the wall
    assert touched > 10


def test_discs_collide_in_the_middle_of_where_they_overlap(make: Make) -> None:
    """From 2.3 m, where the obstacle begins, to 2.5 m, where the robot ends."""
    env = make("""
world: {width: 12, height: 4}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.5}, state: [2, 2, 0], goal: [8, 2, 0]}
obstacle: {shape: {name: circle, radius: 0.3}, state: [2.6, 2, 0]}
""")
    env.step()
    [event] = env.events
    assert (event.kind, event.step) == ("collision", 0)
    assert (event.x, event.y) == pytest.approx((2.4, 2.0), abs=1e-12)
