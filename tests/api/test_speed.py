"""``irsim.run(…, show=True, speed=…)``: how long a window shows each frame."""

from __future__ import annotations

import pytest

from irsim import api
from irsim.env.old.env_plot import EnvPlot
from tests.cli.conftest import ROOM


@pytest.mark.parametrize("speed", [1.0, 4.0])
def test_a_window_shows_a_frame_for_its_share_of_a_step(monkeypatch: pytest.MonkeyPatch, speed: float) -> None:
    pauses = list[float]()
    monkeypatch.setattr(EnvPlot, "pause", lambda self, interval: pauses.append(interval))
    api.run(text=ROOM, steps=3, show=True, speed=speed)
    assert pauses[1:]
    assert pauses[1:] == pytest.approx([0.1 / speed] * len(pauses[1:]))
