"""Lidars that one can buy: every card is valid, has sources, and gives way to keys of the scenario."""

from __future__ import annotations

import pytest

from irsim.components.sensors._devices import DEVICES
from irsim.components.sensors.lidar2d import Lidar2d


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
