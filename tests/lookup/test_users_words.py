"""Words and units of users that the language does not have lead somewhere useful."""

from __future__ import annotations

import pytest

from irsim import api
from irsim.lookup import lookup
from irsim.lookup.full_text import words_of
from irsim.lookup.things import THINGS
from irsim.scenario.model.json_schema import json_schema

pytestmark = pytest.mark.one_python

SCHEMA = json_schema()
MEANT = {
    "agv": "AGV, AMR, delivery robot, 搬运机器人",
    "forklift": "forklift, pallet jack, Gabelstapler, montacargas, 叉车",
    "tug": "tug, trailer, platoon, Anhänger, remolque, 拖车",
    "cart": "cart, trolley, shopping carts, stroller, Einkaufswagen, carrito, 手推车",
    "wheelchair": "wheelchair, Rollstuhl, silla de ruedas, 轮椅",
    "vacuum": "Roomba, vacuum, robot vacuum, Saugroboter, aspiradora, 扫地机器人",
    "shuttle": "shuttle, shuttle bus",
    "legged": "quadruped, legged, humanoid, robot dog, cuadrúpedo, 四足机器人, 人形机器人",
    "drone": "drone, UAV, flying, Drohne, dron, 无人机",
    "arm": "arm, robot arm, gripper, pick and place, Greifer, brazo, 机械臂",
    "elevator": "elevator, lift, escalator, Aufzug, ascensor, 电梯",
    "stairs": "stairs, ramp, slope, Treppe, rampa, 楼梯",
    "floor": "carpet, rug, grass, ice, Teppich, alfombra, 地毯",
    "person": "kid, children, elderly, nurse, Fußgänger, Kinder, peatón, gente, 行人, 孩子",
    "animal": "dog, Katze, perro, 狗",
    "waiting": "wait, pauses, dwell, warten, esperar, 等待, 站住",
    "endless": "for ever, forever, infinite, endlos, para siempre, 永远",
    "conveyor": "conveyor belt, automatic door, Schiebetür, 自动门",
    "dock": "charging station, docking station, Ladestation, 充电桩",
}


@pytest.mark.parametrize("thing", MEANT)
def test_a_word_for_a_thing_leads_to_what_takes_its_place(thing: str) -> None:
    for word in MEANT[thing].split(", "):
        answer = lookup(word, schema=SCHEMA)
        assert (word, answer.topic) == (word, thing)
        assert len(answer.text) < 600  # shorter than the list of all limits


def test_no_word_stands_for_two_things() -> None:
    words = [tuple(words_of(word)) for name, thing in THINGS.items() for word in (name, *thing.words)]
    assert sorted(words) == sorted(set(words))


@pytest.mark.parametrize("thing", [name for name, thing in THINGS.items() if thing.example])
def test_examples_of_things_are_valid(thing: str) -> None:
    example = THINGS[thing].example or ""
    robot = "" if "robot:" in example else "robot: {state: [1, 1, 0], kinematics: {name: diff}, goal: [9, 9]}\n"
    text = example if ":" in example.split(" ")[0] and example.split(":")[0] in ("robot", "obstacle", "world") else ""
    report = api.validate(text=f"{robot}{text}\n" + ("" if "world:" in text else "world: {width: 16, height: 12}\n"))
    assert [finding for finding in report.findings if finding.severity == "error"] == []


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("feet", "1 feet = 0.3048 m"),
        ("mph", "1 mph = 0.44704 m/s"),
        ("12 ft", "12 ft = 3.6576 m"),
        ("10 x 20 feet", "10 x 20 feet = 3.048 x 6.096 m"),
        ("12 ft x 20 ft", "12 ft x 20 ft = 3.6576 x 6.096 m"),
        ("10 feet by 6 in", "10 feet by 6 in = 3.048 x 0.1524 m"),
        ("5 ft 10 in", "5 ft 10 in = 1.778 m"),
        ("20-30 mph", "20-30 mph = 8.9408-13.411 m/s"),
        ("270 degrees", "270 degrees = 4.7124 rad"),
        ("-90°", "-90° = -1.5708 rad"),
        ("120 rpm", "120 rpm = 12.566 rad/s"),
        ("8 kn", "8 kn = 4.1156 m/s"),
        ("36 km/h", "36 km/h = 10 m/s"),
        ("3 Zoll", "3 zoll = 0.0762 m"),
        ("10英尺", "10英尺 = 3.048 m"),
        ("pies", "1 pies = 0.3048 m"),
        ("Fuß", "1 fuß = 0.3048 m"),
    ],
)
def test_units_are_converted(asked: str, said: str) -> None:
    answer = lookup(asked, schema=SCHEMA)
    assert answer.title == said
    assert "1 in = 0.0254 m" in answer.text
    assert "270: 4.7124" in answer.text


@pytest.mark.parametrize("asked", ["360 degree lidar", "lidar2d", "car in a room", "min speed"])
def test_other_words_are_no_units(asked: str) -> None:
    assert "0.0254" not in lookup(asked, schema=SCHEMA).text


@pytest.mark.parametrize(
    ("word", "topic"),
    [
        ("Roboter", "robot"),
        ("obstáculos", "obstacle"),
        ("激光雷达", "robot.sensors.lidar2d"),
        ("Geschwindigkeit", "robot.vel_max"),
        ("pasillo", "corridor-passing"),
        ("停车场", "car-park"),
        ("parking lot", "car-park"),
        ("Ziel", "robot.goal"),
    ],
)
def test_words_of_other_languages_lead_to_keys_and_templates(word: str, topic: str) -> None:
    answer = lookup(word, schema=SCHEMA)
    assert topic in [answer.topic, *(key.name for keys in answer.groups.values() for key in keys)][:3]
