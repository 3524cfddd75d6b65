"""Maps that the map server of ROS ships with: large parts of them are unknown."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from irsim import api
from irsim.bridges.maps import import_map
from irsim.scenario.read import read

pytestmark = pytest.mark.foreign


@pytest.mark.parametrize(("name", "area"), [("tb3_sandbox", 19.8), ("depot", 448.7)])
def test_what_is_known_to_be_free_counts(foreign, tmp_path, name, area) -> None:
    result = import_map(foreign / "ros-maps" / f"{name}.yaml", tmp_path / "map.yaml", robot=True)
    assert result.free_area == pytest.approx(area, abs=0.06)
    assert result.trip is not None
    source = read({"world": {"obstacle_map": {"name": "ros", "path": str(foreign / "ros-maps" / f"{name}.yaml")}}})
    assert source.scenario is not None
    picture = np.asarray(Image.open(tmp_path / "map.png"))
    assert ((picture > 190) & (picture < 220)).sum() == result.unknown, "unknown cells are drawn as unknown"
    assert api.run(tmp_path / "map.yaml", seed=1).outcome == "success"
