"""Stages written by OpenUSD's own library: placement, units, axes, instances, and what is refused."""

from __future__ import annotations

import math
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import turn_of
from irsim.bridges.maps import import_map, read_sidecar
from irsim.bridges.maps.importing import read_occupancy
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from irsim.components.maps._site import FREE
from irsim.scenario.read import read
from tests.bridges.maps.scenes import box, flat, house, y_up

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("usd")]
pxr = pytest.importorskip("pxr")
from pxr import Gf, Usd, UsdGeom, UsdUtils, Vt  # noqa: E402

from irsim.bridges.maps.kinds._usd_process import Collector  # noqa: E402


def add_mesh(stage, path: str, triangles: np.ndarray):
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(triangles.reshape(-1, 3), np.float32)))
    mesh.CreateFaceVertexCountsAttr([3] * len(triangles))
    mesh.CreateFaceVertexIndicesAttr(list(range(3 * len(triangles))))
    return mesh


def new_stage(file: Path, up: str = "Z", unit: float = 1.0):
    stage = Usd.Stage.CreateNew(str(file))
    UsdGeom.SetStageUpAxis(stage, up)
    UsdGeom.SetStageMetersPerUnit(stage, unit)
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    return stage, world


@pytest.mark.parametrize(("up", "unit", "suffix"), [("Z", 1.0, "usda"), ("Y", 0.01, "usdc"), ("Y", 1.0, "usd")])
def test_a_flat_in_any_unit_and_axis(up, unit, suffix) -> None:
    file = Path(f"flat.{suffix}")
    stage, world = new_stage(file, up, unit)
    triangles = y_up(flat()) if up == "Y" else flat()
    add_mesh(stage, "/World/flat", triangles / unit)
    UsdGeom.XformCommonAPI(world).SetTranslate(Gf.Vec3d(*(np.array([2.0, 0.0, 0.0]) / unit)))
    stage.Save()
    result = import_map(file, "flat.yaml")
    assert result.free_area == pytest.approx(40.5, abs=0.6)
    assert [round(one.height, 1) for one in result.levels] == [0.0, 2.8]
    scenario = read(Path("flat.yaml")).scenario
    assert scenario.grid.origin[0] == pytest.approx(1.85, abs=0.11)
    sidecar = read_sidecar("flat.yaml")
    table = np.array([2.0 + 1.8, 0.75, -1.45] if up == "Y" else [2.0 + 1.8, 1.45, 0.75]) / unit
    assert sidecar.to_scene([[3.8, 1.45]], height=0.75) == pytest.approx(table[None], abs=0.01 / unit)
    assert sidecar.scale == pytest.approx(1 / unit)


@pytest.mark.parametrize("up", ["Z", "Y"])
def test_a_stage_is_turned_by_hand_in_its_own_axes(up) -> None:
    turn = turn_of(*np.radians([25, -70, 0]))
    triangles = y_up(flat()) if up == "Y" else flat()
    stage, _ = new_stage(Path("tilted.usda"), up)
    add_mesh(stage, "/World/flat", triangles @ turn)
    stage.Save()
    result = import_map("tilted.usda", "tilted.yaml", rotate=(25, -70, 0))
    assert result.free_area == pytest.approx(40.5, abs=1.6)  # walls lie on borders of cells
    table = np.array([1.8, 0.75, -1.45] if up == "Y" else [1.8, 1.45, 0.75])
    np.testing.assert_allclose(
        read_sidecar("tilted.yaml").to_scene([[1.8, 1.45]], height=0.75), [table @ turn], atol=0.01
    )


def test_a_large_stage_gets_cells_that_fit() -> None:
    stage, _ = new_stage(Path("town.usda"))
    add_mesh(stage, "/World/ground", box([0, 0, 0], [150, 150, 0.1]))
    stage.Save()
    result = import_map("town.usda", "town.yaml")
    assert result.resolution == 0.1
    assert any("cells are 0.1 m" in note for note in result.notes)


def test_a_stage_that_does_not_say_its_unit() -> None:
    stage, _ = new_stage(Path("flat.usda"))
    add_mesh(stage, "/World/flat", flat())
    stage.ClearMetadata("metersPerUnit")
    stage.ClearMetadata("upAxis")
    stage.Save()
    with pytest.raises(BridgeError, match=r"--up y or z.*--meters-per-unit"):
        import_map("flat.usda", "flat.yaml")
    result = import_map("flat.usda", "flat.yaml", up="z", meters_per_unit=1)
    assert result.free_area == pytest.approx(40.5, abs=0.6)
    sidecar = read_sidecar("flat.yaml")
    assert sidecar.to_scene([[1.8, 1.45]], height=0.75) == pytest.approx(np.array([[1.8, 1.45, 0.75]]), abs=1e-9)


def test_turned_mirrored_and_instanced() -> None:
    """Two instances of a room, one mirrored, beside a cube that is scaled; what is hidden or a guide does not count."""
    file = Path("rooms.usda")
    stage, _ = new_stage(file)
    prototype = stage.CreateClassPrim("/Prototype")
    add_mesh(stage, "/Prototype/floor", box([0, 0, -0.1], [4, 3, 0]))
    for name, x, scale in [("a", 0.0, (1, 1, 1)), ("b", 8.0, (-1, 1, 1))]:
        instance = UsdGeom.Xform.Define(stage, f"/World/{name}")
        instance.GetPrim().GetReferences().AddInternalReference("/Prototype")
        instance.GetPrim().SetInstanceable(True)
        api = UsdGeom.XformCommonAPI(instance)
        api.SetTranslate((x, 0, 0))
        api.SetScale(scale)
    assert prototype
    cube = UsdGeom.Cube.Define(stage, "/World/pillar")
    cube.CreateSizeAttr(2.0)
    UsdGeom.XformCommonAPI(cube).SetTranslate((2.0, 1.5, 1.0))
    UsdGeom.XformCommonAPI(cube).SetScale((0.25, 0.25, 1.0))
    hidden = add_mesh(stage, "/World/hidden", box([5, 1, 0], [6, 2, 2]))
    UsdGeom.Imageable(hidden).MakeInvisible()
    guide = add_mesh(stage, "/World/guide", box([6, 1, 0], [7, 2, 2]))
    guide.CreatePurposeAttr(UsdGeom.Tokens.guide)
    UsdGeom.Points.Define(stage, "/World/points")
    stage.Save()
    result = import_map(file, "rooms.yaml")
    assert result.free_area == pytest.approx(8 * 3 - 0.5 * 0.5, rel=0.02)
    assert any("Points" in note for note in result.notes)


def test_shapes_and_instances_of_instancers() -> None:
    """A pillar, a ball, a tank on its side and crates of an instancer stand in a hall; its prototypes do not."""
    file = Path("shapes.usda")
    stage, _ = new_stage(file)
    UsdGeom.Plane.Define(stage, "/World/floor").CreateWidthAttr(10.0)
    UsdGeom.Plane(stage.GetPrimAtPath("/World/floor")).CreateLengthAttr(6.0)
    kinds = ("Cylinder", "Sphere", "Capsule", "Cone")
    places = {kind: (2.0 * k - 4, 2.0, 0.5) for k, kind in enumerate(kinds)}
    for kind, place in places.items():
        shape = getattr(UsdGeom, kind).Define(stage, f"/World/{kind}")
        shape.CreateRadiusAttr(0.5)
        if kind != "Sphere":
            shape.CreateHeightAttr(1.0)
            shape.CreateAxisAttr("X" if kind == "Capsule" else "Z")
        UsdGeom.XformCommonAPI(shape).SetTranslate(Gf.Vec3d(*place))
    crates = UsdGeom.PointInstancer.Define(stage, "/World/crates")
    UsdGeom.XformCommonAPI(crates).SetTranslate(Gf.Vec3d(0, -2, 0.5))
    crate = UsdGeom.Cube.Define(stage, "/World/crates/prototypes/crate")
    crate.CreateSizeAttr(1.0)
    crates.CreatePrototypesRel().SetTargets([crate.GetPath()])
    crates.CreateProtoIndicesAttr([0, 0, 0])
    crates.CreateIdsAttr([7, 8, 9])
    crates.CreatePositionsAttr([(-3, 0, 0), (0, 0, 0), (3, 0, 0)])
    crates.CreateInvisibleIdsAttr([8])
    stage.Save()
    _, plan, _ = read_occupancy(file, ImportOptions(), ImportLimits())
    assert not plan.notes
    assert plan.regions[0] == pytest.approx(60 - 2 - 3 * math.pi / 4 - (1 + math.pi / 4), abs=1.2)

    def stands(x: float, y: float) -> bool:
        return bool(plan.values.reshape(-1)[plan.grid.column_at(x, y)] != FREE)

    assert all(stands(x, y) for x, y, _ in places.values())
    assert [stands(x, -2) for x in (-3, 0, 3)] == [True, False, True]
    assert [stands(x, 2) for x in (-4.6, -4.45, -2.6, -0.9, 0.9, 1.2, 2.6)] == [0, 1, 0, 1, 1, 0, 0]
    assert [stands(0, y) for y in (1.4, 1.6, 2.4, 2.6)] == [0, 1, 1, 0]


def test_shapes_look_outwards() -> None:
    stage = Usd.Stage.CreateInMemory()
    for kind, share in {"Cylinder": 2, "Sphere": 4 / 3, "Capsule": 10 / 3, "Cone": 2 / 3}.items():
        for axis in "XYZ" if kind != "Sphere" else "Z":
            shape = getattr(UsdGeom, kind).Define(stage, "/shape")
            shape.CreateRadiusAttr(1.0)
            if kind != "Sphere":
                shape.CreateHeightAttr(2.0)
                shape.CreateAxisAttr(axis)
            corners = Collector(10_000).stage(stage)
            a, b, c = corners.transpose(1, 0, 2)
            assert (np.cross(a, b) * c).sum() / 6 == pytest.approx(share * math.pi, rel=0.02)
            low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
            along = {"Cylinder": 1, "Sphere": 1, "Capsule": 2, "Cone": 1}[kind]
            wanted = np.where(np.array(list("XYZ")) == axis, along, 1.0)
            np.testing.assert_allclose([-low, high], [wanted, wanted], atol=0.01)
            stage.RemovePrim("/shape")


def test_instances_are_counted_before_they_are_made() -> None:
    file = Path("many.usda")
    stage, _ = new_stage(file)
    for depth in range(4):
        crates = UsdGeom.PointInstancer.Define(stage, "/World/" + "/".join(f"x{k}" for k in range(depth + 1)))
        child = "/World/" + "/".join(f"x{k}" for k in range(depth + 2))
        crates.CreatePrototypesRel().SetTargets([child])
        crates.CreateProtoIndicesAttr([0] * 200)
        crates.CreatePositionsAttr([(k, 0, 0) for k in range(200)])
    UsdGeom.Cube.Define(stage, child)
    stage.Save()
    with pytest.raises(BridgeError, match="more than 20,000,000 triangles"):
        import_map(file, "many.yaml")


def test_polygons_with_more_corners_and_left_handed_ones() -> None:
    stage, _ = new_stage(Path("a.usda"))
    mesh = UsdGeom.Mesh.Define(stage, "/World/floor")
    mesh.CreatePointsAttr([(0, 0, 0), (4, 0, 0), (5, 2, 0), (4, 4, 0), (0, 4, 0)])
    mesh.CreateFaceVertexCountsAttr([5])
    mesh.CreateFaceVertexIndicesAttr([0, 4, 3, 2, 1])
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    stage.Save()
    assert import_map("a.usda", "a.yaml").free_area == pytest.approx(18, rel=0.03)


def test_an_archive_and_levels() -> None:
    stage, _ = new_stage(Path("house.usdc"), "Y")
    add_mesh(stage, "/World/house", y_up(house()))
    stage.Save()
    assert UsdUtils.CreateNewUsdzPackage("house.usdc", "house.usdz")
    upper = import_map("house.usdz", "up.yaml", level=1)
    assert upper.height == pytest.approx(2.8, abs=0.01)
    with zipfile.ZipFile("bomb.usdz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write("house.usdc", "house.usdc")
    with pytest.raises(BridgeError, match="compressed"):
        import_map("bomb.usdz", "x.yaml")


def test_layers_beside_the_stage_are_read_and_others_are_not() -> None:
    Path("scene/parts").mkdir(parents=True)
    for folder in ("scene/parts", ""):
        part = Usd.Stage.CreateNew(str(Path().absolute() / folder / "part.usda"))
        UsdGeom.SetStageMetersPerUnit(part, 1.0)
        part.SetDefaultPrim(UsdGeom.Xform.Define(part, "/Part").GetPrim())
        add_mesh(part, "/Part/floor", box([0, 0, -0.1], [4, 3, 0]))
        part.Save()
    for reference, said in [
        ("./parts/part.usda", None),
        ("./parts/none.usda", "no visible meshes; one of its layers was not found: 'none.usda'"),
        ("../part.usda", "outside of its folder"),
        (str(Path().absolute() / "part.usda"), "outside of its folder"),
        ("https://127.0.0.1:9/part.usda", "outside of its folder"),
    ]:
        file = Path("scene/scene.usda")
        file.write_text(
            f'#usda 1.0\n(\n    upAxis = "Z"\n    metersPerUnit = 1\n)\ndef Xform "World" (\n'
            f"    prepend references = @{reference}@\n)\n{{\n}}\n"
        )
        if said is None:
            assert import_map(file, "ok.yaml").free_area == pytest.approx(12, rel=0.03)
        else:
            with pytest.raises(BridgeError, match=said):
                import_map(file, "x.yaml")


def test_damaged_and_hostile_stages() -> None:
    stage, _ = new_stage(Path("good.usdc"))
    mesh = add_mesh(stage, "/World/box", box([0, 0, 0], [2, 2, 1]))
    stage.Save()
    content = Path("good.usdc").read_bytes()
    for length in (8, 60, len(content) // 2, len(content) - 3):
        Path("cut.usdc").write_bytes(content[:length])
        with pytest.raises(BridgeError):
            import_map("cut.usdc", "x.yaml")
    text = Path("text.usda")
    text.write_text('#usda 1.0\ndef Mesh "a" {\n    point3f[] points = [(0,')
    with pytest.raises(BridgeError):
        import_map(text, "x.yaml")
    for name, points, counts, index, said in [
        ("nan", [(np.nan, 0, 0), (1, 0, 0), (0, 1, 0)], [3], [0, 1, 2], "not numbers"),
        ("index", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [3], [0, 1, 7], "does not have"),
        ("count", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [2000000000], [0, 1, 2], "need 2,000,000,000"),
        ("negative", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [-3], [0, 1, 2], "need"),
        ("empty", [], [], [], "no visible meshes"),
    ]:
        stage, _ = new_stage(Path(f"{name}.usda"))
        mesh = UsdGeom.Mesh.Define(stage, "/World/a")
        mesh.CreatePointsAttr(points)
        mesh.CreateFaceVertexCountsAttr(counts)
        mesh.CreateFaceVertexIndicesAttr(index)
        stage.Save()
        with pytest.raises(BridgeError, match=said):
            import_map(f"{name}.usda", "x.yaml")
    with pytest.raises(BridgeError, match=r"longer than 0\.01 s"):
        import_map("good.usdc", "x.yaml", limits=ImportLimits(seconds=0.01))
    assert not Path("x.yaml").exists()


def test_changed_bytes_never_end_the_program() -> None:
    stage, _ = new_stage(Path("good.usdc"))
    add_mesh(stage, "/World/box", box([0, 0, 0], [2, 2, 1]))
    stage.Save()
    content = Path("good.usdc").read_bytes()
    rng = np.random.default_rng(3)
    for _ in range(5):
        spoiled = bytearray(content)
        for place in rng.integers(8, len(content), 12):
            spoiled[place] = rng.integers(256)
        Path("spoiled.usdc").write_bytes(spoiled)
        with suppress(BridgeError):
            import_map("spoiled.usdc", "x.yaml", overwrite=True)
