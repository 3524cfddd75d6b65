"""Every file of the folder of foreign files comes in as its kind should, or is named with its reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.pedestrians.importing import import_pedestrians
from irsim.bridges.ros.bags.importing import import_bag
from irsim.policies.converters.convert import convert_policy

pytestmark = [pytest.mark.interop, pytest.mark.foreign, pytest.mark.xdist_group("usd")]
for _library in ("pxr", "trimesh", "gaussforge", "rosbags"):
    pytest.importorskip(_library)

_ROOM, _BALL, _POT, _POTS = (108.16, 8.46), (4.41, 0.43), (6.12, 0.505), (1501.08, 35.56)
MAPS = {
    "ros-maps/tb3_sandbox.yaml": (19.8, 2.18),
    "ros-maps/depot.yaml": (448.7, 14.87),
    "gazebo/inner_walls.sdf": (34.6, 1.05),
    "gazebo/house.sdf": (178.3, 15.68),
    "gltf/nav_test_draco.glb": (81.5, 61.87),
    **{f"gltf/{name}.glb": _ROOM for name in ("simple_room", "room_draco", "room_meshopt", "room_quant")},
    **{f"usd/intent-vfx/assets/simpleAsset/{name}.usd": _BALL for name in ("geo", "mtl", "payload", "simpleAsset")},
    **{
        f"usd/intent-vfx/assets/teapot/{name}.usd": _POT
        for name in ("geo/UtahTeapot", "geo", "mtl", "payload", "teapot")
    },
    "usd/intent-vfx/scenes/simpleAssetScene.usd": (32.8, 1.16),
    "usd/intent-vfx/scenes/teapotScene.usd": _POTS,
    "usd/intent-vfx/scenes/teapotScene_layout.usd": _POTS,
}
"""Free and occupied area of the map of each file [m²]."""
REFUSED = {
    **{
        f"splats/{name}": "show no connected floor|no splat stands|no splat is level"
        for name in ("m.splat", "m.ksplat", "mv4.spz", "s_train.spz", "s_train.compressed.ply")
    },
    **{
        f"usd/intent-vfx/scenes/teapotScene_{name}.usd": "has no visible meshes"
        for name in ("animCycle", "camera", "layoutOverrides")
    },
}
"""The words of the message about a file that is read, but shows no place to drive on."""
PARTS = {"ros-maps/tb3_sandbox.pgm": "ros-maps/tb3_sandbox.yaml", "ros-maps/depot.pgm": "ros-maps/depot.yaml"}
"""Files that another one names."""
PEDESTRIANS = [
    f"pedestrians/{name}.txt" for name in ("eth_obsmat", "hotel_obsmat", "trajectron_zara01", "trajnet_test_zara01")
]
BAGS, POLICIES = ["bags/csail.bag"], ["policies/rl_rvo_pre_train.pt"]


def options_of(foreign: Path, name: str) -> dict[str, object]:
    """Stages refer to ``../assets``, and have no ground."""
    if not name.startswith("usd/"):
        return {}
    coarse = 0.2 if name.startswith("usd/intent-vfx/scenes/teapot") else 0.05
    return {"root": str(foreign / "usd" / "intent-vfx"), "ground": 0.0, "resolution": coarse}


def test_no_file_is_left_out(foreign) -> None:
    there = {str(file.relative_to(foreign)) for file in foreign.rglob("*") if file.is_file()}
    assert there == {*MAPS, *REFUSED, *PARTS, *PEDESTRIANS, *BAGS, *POLICIES}
    for part, whole in PARTS.items():
        assert Path(part).name in (foreign / whole).read_text()


@pytest.mark.parametrize("name", MAPS)
def test_maps(foreign, name) -> None:
    result = import_map(foreign / name, "map.yaml", **options_of(foreign, name))
    areas = result.free_area, result.occupied * result.resolution**2
    assert areas == pytest.approx(MAPS[name], rel=0.015)
    with Image.open("map.png") as picture:
        assert picture.size == (result.columns, result.rows)


@pytest.mark.parametrize("name", REFUSED)
def test_files_without_a_place_to_drive_on(foreign, name) -> None:
    with pytest.raises(BridgeError, match=REFUSED[name]):
        import_map(foreign / name, "map.yaml", **options_of(foreign, name))


@pytest.mark.parametrize("name", PEDESTRIANS)
def test_people(foreign, name) -> None:
    assert import_pedestrians(foreign / name, "people.yaml").pedestrians >= 50


@pytest.mark.parametrize("name", BAGS)
def test_logs(foreign, name) -> None:
    assert import_bag(foreign / name, "log.yaml").scans == 406


@pytest.mark.parametrize("name", POLICIES)
def test_weights(foreign, name) -> None:
    """The published weights of RL-RVO, of which nothing is kept."""
    convert_policy("rl_rvo", foreign / name, "policy.npz")
    assert Path("policy.npz").stat().st_size > 100_000
