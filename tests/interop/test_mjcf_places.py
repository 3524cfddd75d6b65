"""Outlines of models of MuJoCo are where MuJoCo itself has the geoms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.maps.kinds.mjcf import read
from irsim.bridges.maps.source import ImportLimits, ImportOptions

pytestmark = pytest.mark.interop
mujoco = pytest.importorskip("mujoco")
_WEDGE = "0 0 0 2 0 0 0 2 0 0 0 1 2 0 1 0 2 1"
_MODEL = """<mujoco>
<compiler {compiler}/>
<default><geom type="box" size="0.5 0.3 0.2"/>
  <default class="thin"><geom size="0.1 0.2 0.6" euler="{turn}"/>
    <default class="pole"><geom type="capsule" size="0.2 0.5"/></default></default></default>
<asset><mesh name="wedge" vertex="{wedge}" scale="1 0.5 2" refpos="0.3 0.2 0.1" refquat="0.8 0.1 0.2 0.3"/></asset>
<worldbody>
  <geom name="a" pos="1 2 3" euler="{turn}"/>
  <body pos="3 -1 0.5" euler="{turn}" childclass="thin">
    <geom name="b" pos="0.3 0.1 0"/>
    <geom name="c" class="main" axisangle="1 2 3 {angle}"/>
    <frame pos="0 1 0" xyaxes="1 1 0 0 1 1">
      <geom name="d" class="pole" quat="1 2 3 4"/>
      <body pos="1 0 0" zaxis="1 -1 2"><geom name="e" zaxis="0 0 -1"/>
        <geom name="f" class="main" type="mesh" mesh="wedge" pos="0 2 1" euler="{turn}"/></body>
    </frame>
  </body>
  <geom name="g" size="0.2" fromto="0 0 0 1 2 3"/>
  <geom name="h" class="thin" fromto="1 0 0 -1 0.5 0.2"/>
</worldbody>
</mujoco>"""


def _corners(model, data, number: int) -> np.ndarray:
    """(N, 2) corners of a geom, seen from above; a capsule has the ends of its axis instead."""
    if model.geom_type[number] == mujoco.mjtGeom.mjGEOM_MESH:
        local = model.mesh_vert.copy()
    elif model.geom_type[number] == mujoco.mjtGeom.mjGEOM_CAPSULE:
        local = np.array([[0, 0, 1], [0, 0, -1]]) * model.geom_size[number][1]
    else:
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        local = signs * model.geom_size[number]
    return (local @ data.geom_xmat[number].reshape(3, 3).T + data.geom_xpos[number])[:, :2]


@pytest.mark.parametrize(
    ("compiler", "turn", "angle"),
    [
        ("", "20 50 -70", "40"),
        ('angle="radian"', "0.3 0.9 -1.2", "0.7"),
        ('eulerseq="zyx"', "20 50 -70", "40"),
        ('eulerseq="XYZ"', "20 50 -70", "40"),
        ('eulerseq="xZy"', "20 50 -70", "40"),
    ],
)
def test_geoms_are_where_mujoco_has_them(compiler, turn, angle) -> None:
    text = _MODEL.format(compiler=compiler, turn=turn, angle=angle, wedge=_WEDGE)
    Path("m.xml").write_text(text)
    things = read(Path("m.xml"), ImportOptions(height=-40, climb=0, headroom=80), ImportLimits()).things
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert len(things) == model.ngeom == 8
    for thing in things:
        number = model.geom(thing.name).id
        corners = _corners(model, data, number)
        wide = model.geom_size[number][0] if model.geom_type[number] == mujoco.mjtGeom.mjGEOM_CAPSULE else 0.0
        expected = [*(corners.min(axis=0) - wide), *(corners.max(axis=0) + wide)]
        assert thing.region.bounds == pytest.approx(expected, abs=0.002 if wide else 1e-5), thing.name
