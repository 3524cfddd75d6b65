"""What ``irsim bridge doctor`` says of CARLA: its client, tried on a road without a server."""

from __future__ import annotations

import math
import sys

import numpy as np

from irsim.bridges.carla.client import NEWEST_PYTHON
from irsim.bridges.carla.places import Places
from irsim.bridges.doctor import Part

__all__ = ["LEFT_CURVE", "PARTS"]

_LENGTH, _CURVATURE = 20.0, 0.05
LEFT_CURVE = f"""<?xml version="1.0"?>
<OpenDRIVE>
  <header revMajor="1" revMinor="4" name="curve" version="1" north="0" south="0" east="0" west="0">
    <geoReference><![CDATA[+proj=tmerc +lat_0=0 +lon_0=0]]></geoReference>
  </header>
  <road name="curve" length="{_LENGTH}" id="1" junction="-1">
    <link/>
    <planView>
      <geometry s="0" x="0" y="0" hdg="0" length="{_LENGTH}"><arc curvature="{_CURVATURE}"/></geometry>
    </planView>
    <elevationProfile><elevation s="0" a="0" b="0" c="0" d="0"/></elevationProfile>
    <lateralProfile/>
    <lanes>
      <laneSection s="0">
        <center><lane id="0" type="none" level="false"/></center>
        <right>
          <lane id="-1" type="driving" level="false"><link/><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>
        </right>
      </laneSection>
    </lanes>
  </road>
</OpenDRIVE>
"""
"""A road of OpenDRIVE that turns left; its frame is that of irsim."""


def _curve() -> str:
    """Follow the road in the client and in irsim."""
    import carla

    road = carla.Map("curve", LEFT_CURVE)
    angle, radius = _LENGTH / 2 * _CURVATURE, 1 / _CURVATURE + 1.75  # the lane is to the right of the arc
    middle = np.array([radius * math.sin(angle), 1 / _CURVATURE - radius * math.cos(angle), angle])
    at = road.get_waypoint_xodr(1, -1, _LENGTH / 2).transform
    found = Places().to_irsim(np.array([at.location.x, at.location.y, at.rotation.yaw]))
    if not np.allclose(found, middle, atol=0.05):
        raise ValueError(f"the middle of a left curve is at {found.round(2).tolist()}, not {middle.round(2).tolist()}")
    return "the client reads a road, whose left curve is where irsim has it; a server was not asked"


_NONE = "CARLA has no client for this Python: use Python 3.10 to 3.12, then pip install 'irsim-mcp[carla]'"
PARTS = (
    Part("carla", "carla", "carla", _curve) if sys.version_info[:2] <= NEWEST_PYTHON else Part("carla", None, _NONE),
)
"""The libraries of the bridge."""
