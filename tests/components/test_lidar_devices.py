"""Range sensors that one can buy: every card is valid, has sources, and gives way to keys of the scenario."""

from __future__ import annotations

from typing import Any

import pytest

from irsim.components.sensors._devices import DEPTH_CAMERAS, DEVICES, INFRARED, SONARS
from irsim.components.sensors.depth_scan import DepthScan
from irsim.components.sensors.ir_range import IrRange
from irsim.components.sensors.lidar2d import Lidar2d
from irsim.components.sensors.sonar import Sonar

OTHERS = [
    *((DepthScan, "depth_scan", card) for card in DEPTH_CAMERAS.items()),
    *((Sonar, "sonar", card) for card in SONARS.items()),
    *((IrRange, "ir_range", card) for card in INFRARED.items()),
]


def test_there_are_cards_enough() -> None:
    assert len(DEVICES) >= 8


@pytest.mark.parametrize("name", DEVICES)
def test_every_number_of_a_card_has_a_source_and_a_place(name: str) -> None:
    card = DEVICES[name]
    assert set(card.sources) == set(card.keys)
    assert all(source.text for source in card.sources.values())
    assert {"range_min", "range_max", "angle_range", "number", "scan_time"} <= set(card.keys)
    lidar = Lidar2d.model_validate({"name": "lidar2d", "device": name})
    for key, value in card.keys.items():
        of, _, nested = key.rpartition(".")
        assert getattr(lidar.realism if of else lidar, nested) == value


@pytest.mark.parametrize(("model", "sensor", "entry"), OTHERS, ids=[name for *_, (name, _) in OTHERS])
def test_cards_of_other_sensors_have_sources_and_places(model: Any, sensor: str, entry: Any) -> None:
    name, card = entry
    assert set(card.sources) == set(card.keys)
    made = model.model_validate({"name": sensor, "device": name})
    assert {key: getattr(made, key) for key in card.keys} == card.keys
    assert model.model_validate({"name": sensor, "device": name, "range_max": 0.6}).range_max == 0.6


def test_unverified_numbers_are_those_whose_source_nobody_opened() -> None:
    card = DEVICES["tim561"]
    assert "std" not in card.unverified
    assert "range_max" in card.unverified
    assert DEVICES["lds_02"].unverified == []


def test_keys_beside_the_device_win() -> None:
    lidar = Lidar2d.model_validate(
        {"name": "lidar2d", "device": "tim561", "number": 91, "realism": {"bias_std": 0.0, "dropout": 0.1}}
    )
    assert (lidar.number, lidar.range_max) == (91, 10.0)
    assert lidar.realism is not None
    assert (lidar.realism.bias_std, lidar.realism.dropout, lidar.realism.range_dark) == (0.0, 0.1, 8.0)
