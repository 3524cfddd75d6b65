"""Lookups share one JSON Schema of the language, which knows what has been registered since."""

from __future__ import annotations

from typing import Annotated, Literal

import pytest
from pydantic import Field

from irsim.components.options import SensorOptions
from irsim.lookup import TopicError, lookup
from irsim.lookup.language import language_schema
from irsim.options.registry import SENSORS
from irsim.options.units import Meters


class Compass(SensorOptions):
    """Points to the north."""

    name: Literal["compass_of_the_test"] = "compass_of_the_test"
    swing: Annotated[Meters, Field(ge=0)] = 0.25
    """How far its needle swings."""


def knows_compass() -> bool:
    try:
        return "needle" in lookup("robot.sensors.compass_of_the_test.swing").text
    except TopicError:
        return False


def test_the_schema_is_made_once() -> None:
    assert language_schema() is language_schema()


def test_a_feature_registered_later_can_be_looked_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SENSORS, "_features", dict(SENSORS._features))
    assert not knows_compass()
    SENSORS.register(Compass)
    assert lookup("sensor compass_of_the_test").title == "sensor compass_of_the_test"
    assert "How far its needle swings" in lookup("robot.sensors.compass_of_the_test.swing").text
    monkeypatch.undo()
    assert not knows_compass()
