"""Files of places that other programs wrote, which are imported as maps."""

from __future__ import annotations

import json
import random
from collections.abc import Mapping
from pathlib import Path

from PIL import Image

from irsim.bridges.maps.importing import import_map
from tests.bridges.maps.test_commonroad import BOX, obstacle, points
from tests.bridges.maps.test_footprints import Extract, box, feature
from tests.bridges.maps.test_gazebo_worlds import box as sdf_box
from tests.bridges.maps.test_gazebo_worlds import link, model, shape
from tests.fuzz.damaged.kind import IMPORT, Kind, made, read_map_of, text

__all__ = ["PLACES", "ROS_MAP"]

_POLYLINE = "<polyline><height>1</height><point>0 0</point><point>2 0</point><point>0 2</point></polyline>"
_CYLINDER = "<cylinder><radius>0.5</radius><length>1</length></cylinder>"
_MESH = "<mesh><uri>part.obj</uri><scale>1 2 1</scale></mesh>"
_SDF = (
    '<?xml version="1.0"?><sdf version="1.9"><world name="w"><include><uri>other.sdf</uri><pose>4 0 0 0 0 1</pose>'
    "</include><frame name='f' attached_to='m'><pose>1 0 0 0 0 0</pose></frame>"
    + model(link(shape(sdf_box(2, 1)) + shape(_CYLINDER, more='relative_to="l"')))
    + model(link(shape(_POLYLINE) + shape(_MESH)), name="n", more="placement_frame='l'")
    + "</world></sdf>"
)
_OTHER = f'<sdf version="1.9">{model(link(shape(sdf_box(1, 1))))}</sdf>'
_OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 3 2 1\nf 4/1 5/2 6/3\nf 1 2 5 4\nf -5 -4 -1 -2\n"
_MJCF = """\
<mujoco><compiler angle="radian" eulerseq="xyz" meshdir="."/><include file="other.xml"/>
<default><geom size="0.3 0.3 0.5"/><default class="wall"><geom type="box" size="1 0.1 0.5"/></default></default>
<asset><mesh name="w" vertex="0 0 0 2 0 0 0 2 0 0 0 1" scale="2 2 1"/><mesh name="o" file="part.obj"/></asset>
<worldbody><geom class="wall" pos="1 2 0.5" euler="0 0 0.7"/><geom type="mesh" mesh="w"/><geom type="mesh" mesh="o"/>
<body pos="4 0 0" quat="1 0 0 1"><geom type="capsule" size="0.2" fromto="0 0 0.5 2 0 0.5"/>
<geom type="ellipsoid" size="1 0.5 0.4" axisangle="0 0 1 0.4"/></body></worldbody></mujoco>
"""
_LANE = f'<lanelet id="1"><leftBound>{points((0, 4), (20, 4))}</leftBound>'
_LANE += f"<rightBound>{points((0, 0), (20, 0))}</rightBound></lanelet>"
_ROAD = (
    f'<?xml version="1.0"?><commonRoad commonRoadVersion="2020a">{_LANE}{obstacle(BOX, 10, 1, 0.5)}'
    f"{obstacle(f'<polygon>{points((0, 0), (2, 0), (0, 2))}</polygon>', 3, 2)}</commonRoad>"
)
_CELLS = "resolution: 0.5\norigin: [0, 0, 0.3]\nnegate: 0\n"
ROS_MAP = f"image: plan.png\n{_CELLS}occupied_thresh: 0.65\nfree_thresh: 0.196\n"


def _write_footprints(file: Path) -> None:
    yard = feature("Polygon", [box(-20, -10, 20, 20), box(-15, -5, 10, 10)], building="yes", name="Hall", width="3 m")
    two = feature("MultiPolygon", [[box(5, 0, 4, 3)], [box(12, 0, 4, 3)]], building="yes")
    wall = feature("LineString", [[9.0, 0.0001], [9.0001, 0.0001]], barrier="wall")
    file.write_text(json.dumps({"type": "FeatureCollection", "features": [yard, two, wall]}))


def _write_extract(file: Path) -> None:
    extract = Extract()
    extract.way(box(0, 0, 10, 5), building="yes", name="Hall")
    outer, inner = extract.way(box(30, 0, 10, 10)), extract.way(box(33, 3, 4, 4))
    extract.relation({outer: "outer", inner: "inner"}, type="multipolygon", building="yes")
    extract.way([(9.0, 0.0001), (9.0001, 0.0001)], barrier="wall", width="0.3 m")
    file.write_bytes(extract.write().read_bytes())


def _ros_map(folder: Path) -> Path:
    Image.new("L", (20, 20), 255).save(folder / "plan.png")
    return text("map.yaml", ROS_MAP)(folder)


def _read_ros_map(file: Path, draw: random.Random) -> None:
    import_map(file, file.with_name("scene.yaml"), limits=IMPORT, overwrite=True)


def _read_beside(name: str) -> Kind:
    """A mesh that another file names."""

    def read(file: Path, draw: random.Random) -> None:
        main = file.with_name(name)
        import_map(main, file.with_name("scene.yaml"), limits=IMPORT, overwrite=True, resolution=0.2)

    files = {"w.sdf": _SDF, "other.sdf": _OTHER, "m.xml": _MJCF, "other.xml": "<mujoco/>"}
    return Kind(text("part.obj", _OBJ, **files), read, share=2)


PLACES: Mapping[str, Kind] = {
    "sdf": Kind(text("w.sdf", _SDF, **{"other.sdf": _OTHER, "part.obj": _OBJ}), read_map_of, share=2),
    "sdf-mesh": _read_beside("w.sdf"),
    "mjcf": Kind(text("m.xml", _MJCF, **{"other.xml": "<mujoco/>", "part.obj": _OBJ}), read_map_of, share=2),
    "mjcf-mesh": _read_beside("m.xml"),
    "commonroad": Kind(text("a.xml", _ROAD), read_map_of, share=2),
    "geojson": Kind(made(_write_footprints, "a.geojson"), read_map_of, share=2),
    "osm": Kind(made(_write_extract, "a.osm"), read_map_of, share=2),
    "ros-map": Kind(_ros_map, _read_ros_map, share=2),
}
