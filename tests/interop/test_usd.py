"""Stages of OpenUSD: the validators of OpenUSD find no errors, and what is read again is what was simulated."""

from __future__ import annotations

import math
import re
import shlex
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.cli.app import app
from irsim.common.data_files import skills_directory
from tests.bridges.scenes import STAGE, record_stage
from tests.skills.conftest import fences

pytestmark = pytest.mark.interop
pxr = pytest.importorskip("pxr")

from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdValidation  # noqa: E402

from irsim.bridges.export.export import export_run  # noqa: E402
from irsim.bridges.usd.files import SUFFIXES, export_scene, make_stage  # noqa: E402
from irsim.bridges.usd.follow import Follower  # noqa: E402

PERSON = '#usda 1.0\n(\n defaultPrim = "P"\n)\ndef Sphere "P" {\n double radius = 9\n}\n'


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return record_stage(tmp_path_factory.mktemp("usd"))


def validate(stage) -> list[str]:
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) >= 20
    errors = UsdValidation.ValidationContext(validators).Validate(stage)
    return [error.GetErrorAsString() for error in errors]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_run_validates_and_reads_back(run, tmp_path: Path, suffix: str) -> None:
    target = tmp_path / f"run{suffix}"
    result = export_run(run, target)
    assert (result.format, result.steps) == ("usd", run.last_step)
    stage = Usd.Stage.Open(str(target))
    assert validate(stage) == []
    assert stage.GetDefaultPrim().GetPath() == "/World"
    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == ("Z", 1.0)
    assert (stage.GetTimeCodesPerSecond(), stage.GetEndTimeCode()) == (10.0, run.last_step)
    ours = [prim for prim in stage.Traverse() if prim.HasCustomDataKey("irsim:id")]
    prims = {prim.GetCustomDataByKey("irsim:id"): prim for prim in ours}
    scene = recorded_scene(run)
    assert {prim.GetCustomDataByKey("irsim:name") for prim in prims.values()} == set(scene.names)
    assert str(prims[0].GetPath()) == "/World/Robots/robot_1"
    hidden = 0
    for state in recorded_states(run):
        cache = UsdGeom.XformCache(state.step)
        for index, prim in prims.items():
            shown = UsdGeom.Imageable(prim).ComputeVisibility(state.step) == UsdGeom.Tokens.inherited
            x, y, yaw = state.pose[index]
            assert shown == math.isfinite(x)
            if not shown:
                hidden += 1
                continue
            matrix = cache.GetLocalToWorldTransform(prim)
            assert tuple(matrix.ExtractTranslation()) == (x, y, 0.0)
            ahead = matrix.TransformDir(Gf.Vec3d(1, 0, 0))
            assert ahead == pytest.approx((math.cos(yaw), math.sin(yaw), 0), abs=1e-12)
    assert hidden == 4 + run.last_step - 40


def test_headings_do_not_jump(run) -> None:
    stage = make_stage(recorded_scene(run), recorded_states(run))
    turned = stage.GetPrimAtPath("/World/Robots/spinner").GetAttribute("xformOp:rotateZ")
    angles = [turned.Get(step) for step in range(51)]
    assert max(np.abs(np.diff(angles))) < 15
    assert angles[50] == pytest.approx(math.degrees(10.0))


def test_bodies_are_where_they_are_simulated_and_collide(run) -> None:
    stage = make_stage(recorded_scene(run), recorded_states(run))
    cache = UsdGeom.BBoxCache(0, [UsdGeom.Tokens.default_])

    def bounds(path: str):
        box = cache.ComputeWorldBound(stage.GetPrimAtPath(path)).ComputeAlignedRange()
        return [*box.GetMin(), *box.GetMax()]

    assert bounds("/World/Obstacles/disc") == pytest.approx([3.8, 6.7, 0, 4.4, 7.3, 1.0], abs=1e-6)
    assert bounds("/World/Obstacles/wall") == pytest.approx([7.975, 0.975, 0, 9.025, 2.025, 1], abs=1e-6)
    assert bounds("/World/Pedestrians/walker")[5] == pytest.approx(1.77, abs=1e-6)
    walls = bounds("/World/Obstacles/boundary")
    assert walls == pytest.approx([-0.025, -0.025, 0, 12.025, 8.025, 1], abs=1e-6)
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert {mesh.GetSubdivisionSchemeAttr().Get() for mesh in meshes} == {"none"}
    kinds = {
        str(mesh.GetPath()): UsdPhysics.MeshCollisionAPI(mesh).GetApproximationAttr().Get()
        for mesh in meshes
        if mesh.GetPrim().HasAPI(UsdPhysics.CollisionAPI)
    }
    assert kinds["/World/Obstacles/robot_1_2/body/part_0"] == "convexDecomposition"
    assert kinds["/World/Robots/robot_1/body/part_0"] == "convexHull"
    hulls = [UsdGeom.Cylinder(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Cylinder)]
    assert sorted(hull.GetRadiusAttr().Get() for hull in hulls) == [0.2, 0.25, 0.3]
    assert all(hull.GetPrim().HasAPI(UsdPhysics.CollisionAPI) for hull in hulls)
    assert {hull.GetPurposeAttr().Get() for hull in hulls} == {"guide"}, "it is not seen"
    assert kinds["/World/Map"] == "none"
    assert not any("front" in path for path in kinds), "the arrow does not collide"
    walker = stage.GetPrimAtPath("/World/Pedestrians/walker")
    assert UsdPhysics.RigidBodyAPI(walker).GetKinematicEnabledAttr().Get()
    assert not stage.GetPrimAtPath("/World/Obstacles/disc").HasAPI(UsdPhysics.RigidBodyAPI)


def test_a_scenario_that_was_not_run(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(STAGE)
    target = export_scene(tmp_path / "scene.yaml", tmp_path / "start.usda")
    stage = Usd.Stage.Open(str(target))
    assert validate(stage) == []
    where = UsdGeom.XformCache(0).GetLocalToWorldTransform(stage.GetPrimAtPath("/World/Robots/robot_1"))
    assert tuple(where.ExtractTranslation()) == (1, 4, 0)
    late = UsdGeom.Imageable(stage.GetPrimAtPath("/World/Pedestrians/walker"))
    assert late.ComputeVisibility(0) == "invisible"
    with pytest.raises(ValueError, match="suffixes"):
        export_scene(tmp_path / "scene.yaml", tmp_path / "start.obj")


# following ------------------------------------------------------------------------------------------------------------
def place_of(stage, path: str) -> tuple[float, ...]:
    matrix = UsdGeom.XformCache().GetLocalToWorldTransform(stage.GetPrimAtPath(path))
    ahead = matrix.TransformDir(Gf.Vec3d(1, 0, 0))
    return (*matrix.ExtractTranslation(), math.atan2(ahead[1], ahead[0]))


def transform(frame: str, x: float, y: float, yaw: float, parent: str = "world") -> SimpleNamespace:
    rotation = SimpleNamespace(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    moved = SimpleNamespace(translation=SimpleNamespace(x=x, y=y, z=0.0), rotation=rotation)
    return SimpleNamespace(header=SimpleNamespace(frame_id=parent), child_frame_id=frame, transform=moved)


def test_prims_follow_states_to_exact_places(run) -> None:
    stage = make_stage(recorded_scene(run), recorded_states(run))
    before = stage.GetRootLayer().ExportToString()
    follower = Follower(stage)
    for state in recorded_states(run):
        follower.state(state.pose)
        for path, index in (("/World/Robots/robot_1", 0), ("/World/Pedestrians/walker", 5)):
            shown = UsdGeom.Imageable(stage.GetPrimAtPath(path)).ComputeVisibility() == "inherited"
            assert shown == math.isfinite(state.pose[index, 0])
            if shown:
                assert place_of(stage, path)[:2] == tuple(state.pose[index, :2])
    assert stage.GetRootLayer().ExportToString() == before, "the file is not changed"
    follower.release()
    at_start = UsdGeom.XformCache(0).GetLocalToWorldTransform(stage.GetPrimAtPath("/World/Robots/robot_1"))
    assert tuple(at_start.ExtractTranslation()) == (1, 4, 0)


def test_prims_follow_messages_of_ros(run) -> None:
    stage = make_stage(recorded_scene(run))
    follower = Follower(stage)
    heard = [
        transform("robot_1/base_link", 99.0, 0.0, 0.0, parent="odom"),
        transform("robot_1/laser", 3.0, 3.0, 0.0),
        transform("/walker/base_link", 7.25, -1.5, 3.0),
        transform("missing/base_link", 0.0, 0.0, 0.0),
    ]
    follower.transforms(SimpleNamespace(transforms=heard), parent="world")
    assert place_of(stage, "/World/Pedestrians/walker") == pytest.approx((7.25, -1.5, 0, 3.0))
    assert place_of(stage, "/World/Robots/robot_1")[:2] == (1, 4)
    assert follower.unknown == {"missing"}
    follower.transforms(SimpleNamespace(transforms=[transform("walker/base_link", 7.25, -1.5, -3.0)]))
    turned = stage.GetPrimAtPath("/World/Pedestrians/walker").GetAttribute("xformOp:rotateZ").Get()
    assert turned == pytest.approx(math.degrees(math.tau - 3.0)), "the shorter way round"
    turn = transform("", 0, 0, 0.5).transform.rotation
    pose = SimpleNamespace(position=SimpleNamespace(x=1.0, y=2.0), orientation=turn)
    follower.pose_array(SimpleNamespace(poses=[pose]), ["spinner"])
    assert place_of(stage, "/World/Robots/spinner") == pytest.approx((1, 2, 0, 0.5))


def test_prims_of_a_stage_of_ones_own() -> None:
    stage = Usd.Stage.CreateInMemory()
    own = UsdGeom.Xform.Define(stage, "/Characters/Bob")
    own.AddRotateXYZOp().Set(Gf.Vec3f(0, 0, 90))
    own.AddScaleOp().Set(Gf.Vec3f(2, 2, 2))
    quarter = [[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 0.5], [0, 0, 0, 1]]
    follower = Follower(stage, {"walker": "/Characters/Bob"}, transform=quarter)
    assert follower.place("walker", 3.0, 4.0, 0.1)
    assert place_of(stage, "/Characters/Bob") == pytest.approx((6, 23, 0.5, math.pi / 2 + 0.1))
    size = UsdGeom.XformCache().GetLocalToWorldTransform(own.GetPrim()).TransformDir(Gf.Vec3d(0, 0, 1))
    assert size.GetLength() == pytest.approx(2)
    with pytest.raises(ValueError, match="/Missing"):
        Follower(stage, {"walker": "/Missing"})


def test_the_script_for_isaac_sim_follows_and_stops(run, monkeypatch) -> None:
    """With stand-ins for rclpy and Kit: this says nothing about them, but the script is sound."""
    from irsim.bridges.usd import follow, isaac

    stage = make_stage(recorded_scene(run))
    subscribed, called, destroyed = {}, [], []
    node = SimpleNamespace(
        create_subscription=lambda kind, topic, call, depth: subscribed.__setitem__(topic, call),
        destroy_node=lambda: destroyed.append(True),
    )
    waiting = [transform("walker/base_link", 1.0, 2.0, 0.5)]

    def spin_once(node, timeout_sec):
        if waiting:
            subscribed["/tf"](SimpleNamespace(transforms=[waiting.pop()]))

    made = SimpleNamespace(ok=lambda: True, create_node=lambda name: node, spin_once=spin_once)
    kinds = {"geometry_msgs.msg": SimpleNamespace(PoseArray=object), "tf2_msgs.msg": SimpleNamespace(TFMessage=object)}
    app = SimpleNamespace(get_update_event_stream=lambda: SimpleNamespace(create_subscription_to_pop=subscribe))
    kit = SimpleNamespace(get_app=lambda: app)
    usd = SimpleNamespace(get_context=lambda: SimpleNamespace(get_stage=lambda: stage))

    def subscribe(call, name):
        called.append(call)
        return object()

    others = {"rclpy": made, "follow": follow, **kinds, "geometry_msgs": object(), "tf2_msgs": object()}
    omni = SimpleNamespace(kit=SimpleNamespace(app=kit), usd=usd)
    for name, module in {**others, "omni": omni, "omni.kit": omni.kit, "omni.kit.app": kit, "omni.usd": usd}.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(sys, "path", list(sys.path))
    isaac.main()
    called[0](None)
    assert place_of(stage, "/World/Pedestrians/walker") == pytest.approx((1, 2, 0, 0.5))
    isaac.main()
    assert destroyed == [True]
    assert place_of(stage, "/World/Pedestrians/walker")[:2] == (5, 1)


def test_follow_stands_alone() -> None:
    import irsim.bridges.usd

    text = Path(irsim.bridges.usd.__path__[0], "follow.py").read_text()
    imports = re.findall(r"^\s*(?:import|from) (\w+)", text, re.MULTILINE)
    assert set(imports) <= {"__future__", "collections", "math", "re", "typing", "pxr"}


def test_commands_of_the_page(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(STAGE)
    page = (skills_directory() / "irsim-runner" / "bridges" / "usd.md").read_text(encoding="utf-8")
    for command in (line for block in fences(page, "bash") for line in block.splitlines()):
        if command.startswith("irsim "):
            done = CliRunner().invoke(app, shlex.split(command)[1:])
            assert done.exit_code == 0, (command, done.output)
    assert {path.name for path in tmp_path.glob("*.usd?")} == {"run.usdc", "start.usda"}
    [layer] = fences(page, "usda")
    (tmp_path / "mine.usda").write_text(layer.replace("person.usd@", "person.usda@"))
    (tmp_path / "person.usda").write_text(PERSON)
    stage = Usd.Stage.Open(str(tmp_path / "mine.usda"))
    person = stage.GetPrimAtPath("/World/Pedestrians/walker/body/person")
    place = UsdGeom.XformCache(12).GetLocalToWorldTransform(person).ExtractTranslation()
    assert (person.GetTypeName(), tuple(place)) == ("Sphere", pytest.approx((5, 3, 0)))
    assert not stage.GetPrimAtPath("/World/Pedestrians/walker/body/part_0").IsActive()
