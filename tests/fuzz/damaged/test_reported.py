"""Damaged files from reports: each leads to an error with a code, which says what is wrong."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.benchmarks.log import Log, logged
from irsim.bridges.base import BridgeError
from irsim.bridges.maps.importing import import_map
from irsim.bridges.splats.reading import read_splats
from irsim.diagnostics.errors import ArgumentError, CodedError
from irsim.policies.networks import open_network
from irsim.policies.networks.errors import PolicyFileError
from irsim.results.benchmark import BenchmarkResult
from irsim.runs.files import RunError
from irsim.runs.reading import open_run
from irsim_evals.report.load import load_proof
from tests.bridges.splats.scenes import room, write_ply
from tests.runs.conftest import ROOM

pytestmark = pytest.mark.one_python
MAP = "image: plan.png\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def problems(folder: Path, map_file: str) -> list[tuple[str, str]]:
    """Codes and messages of the errors of a scenario with a map."""
    scenario = folder / "hall.yaml"
    scenario.write_text(f"world: {{obstacle_map: {map_file}}}\nrobot: {{kinematics: {{name: diff}}}}\n")
    return [(item.code, item.message) for item in irsim.validate(scenario).findings if item.severity == "error"]


@pytest.mark.parametrize(
    "wrong",
    [
        "resolution: 2020-99-99",
        "resolution: 2020-01-01",
        "resolution: !!timestamp x",
        "resolution: !!int x",
        "resolution: !!python/object/apply:os.system [echo]",
        "resolution: 0b",
        f"resolution: {'9' * 350}",
        f"resolution: {'[' * 300}",
        "negate: &a [*a]",
        "negate: {? [1] : 2}",
    ],
)
def test_maps_with_dates_and_tags_are_unreadable(workspace: Path, wrong: str) -> None:
    Image.new("L", (20, 20), 255).save(workspace / "plan.png")
    key = wrong.partition(":")[0]
    lines = [line for line in MAP.splitlines() if not line.startswith(key)]
    (workspace / "map.yaml").write_text("\n".join([*lines, wrong]) + "\n")
    assert [code for code, _ in problems(workspace, "{name: ros, path: map.yaml}")] == ["map-unreadable"]


@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_a_map_of_infinite_size_is_unreadable(workspace: Path, yaw: float) -> None:
    Image.new("L", (20, 20), 255).save(workspace / "plan.png")
    text = MAP.replace("resolution: 0.5", "resolution: 1.0e+308").replace("0, 0, 0", f"0, 0, {yaw}")
    (workspace / "map.yaml").write_text(text)
    ((code, message),) = problems(workspace, "{name: ros, path: map.yaml}")
    assert code == "map-unreadable"
    assert "pixels of 1e+308 m make a map of infinite size" in message


def test_a_map_with_a_flipped_byte_is_unreadable(workspace: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (30, 30), dtype=np.uint8)
    Image.fromarray(noise).save(workspace / "plan.png")
    content = (workspace / "plan.png").read_bytes()
    assert not problems(workspace, "plan.png")
    for k in range(content.index(b"IDAT") + 4, len(content), 40):
        (workspace / "plan.png").write_bytes(content[:k] + bytes([content[k] ^ 1]) + content[k + 1 :])
        assert problems(workspace, "plan.png")[0][0] == "map-unreadable"
    (workspace / "plan.png").write_bytes(content[:-8])
    assert "ends before its last part" in problems(workspace, "plan.png")[0][1]


def test_a_damaged_header_of_an_array_is_an_error_of_the_policy(tmp_path: Path) -> None:
    array = io.BytesIO()
    np.save(array, np.zeros(3, dtype=np.float32))
    for old, new in ((b"'descr'", b"'''escr'"), (b"(3,)", b"(((("), (b"{", b"\\"), (b"'<f4'", b"'|O0'")):
        with zipfile.ZipFile(tmp_path / "net.npz", "w") as archive:
            archive.writestr("policy.npy", array.getvalue().replace(old, new))
        with pytest.raises(PolicyFileError, match="policy-file"):
            open_network(tmp_path / "net.npz")


@pytest.mark.parametrize(
    "change",
    [
        {"sensors": [[]]},
        {"sensors": [["rover/lidar", -7]]},
        {"sensors": [[None, 7]]},
        {"step_time": float("nan")},
        {"step_time": 0.0},
        {"step_time": 1e300},
        {"seed": -1},
        {"seed": 10**60},
        {"names": [[]]},
        {"maps": [1]},
        {"options": []},
        {"scans_until": "x"},
    ],
)
def test_metadata_of_a_run_that_cannot_be_are_told(workspace: Path, change: dict[str, Any]) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    folder = workspace / ".irsim" / "runs" / str(irsim.run("room.yaml", record=True, steps=3).run_id)
    meta = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**meta, **change}))
    with pytest.raises(RunError, match=r"unreadable-run: .*run.json"):
        open_run(folder.name)


def test_a_changed_description_of_a_run_is_told(workspace: Path) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    folder = workspace / ".irsim" / "runs" / str(irsim.run("room.yaml", record=True, steps=3).run_id)
    file = folder / "resolved.json"
    assert open_run(folder.name).resolved["objects"]
    file.write_text(file.read_text().replace('"vel_dim":2', '"vel_dim":3'))
    with pytest.raises(RunError, match="has been changed"):
        _ = open_run(folder.name).resolved


def test_a_log_with_a_changed_seed_is_not_believed(workspace: Path) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    result = irsim.benchmark("room.yaml", "dash", seeds=[1], steps=3, log="log.jsonl")
    assert isinstance(result, BenchmarkResult)
    log = workspace / "log.jsonl"
    assert logged(log).episodes == result.episodes
    text = log.read_text()
    for old, new in (('"seed":1', '"seed":2'), ('"steps":3', '"steps":2'), ('"number": 0', '"number": 1')):
        head, line = text.split("\n", 1)
        log.write_text(f"{head}\n{line.replace(old, new, 1)}")
        with pytest.raises(RunError, match=r"unreadable-run: line 2 .* has been changed.*--resume"):
            Log.known(log, logged_head(head))


def logged_head(text: str) -> BenchmarkResult:
    return BenchmarkResult.model_validate_json(text)


def test_a_log_of_other_seeds_with_good_digests_is_not_believed(workspace: Path) -> None:
    """The digests are right, but the seed differs from the seed of the plan."""
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    result = irsim.benchmark("room.yaml", "dash", seeds=[1], steps=3, log="log.jsonl")
    head = logged_head((workspace / "log.jsonl").read_text().split("\n", 1)[0])
    with Log("log.jsonl", head, {0: result.episodes[0].model_copy(update={"seed": 2})}):
        pass
    with pytest.raises(RunError, match="it has seed 2"):
        irsim.benchmark("room.yaml", "dash", seeds=[1], steps=3, log="log.jsonl", resume=True)


@pytest.mark.parametrize(("old", "new"), [("0.5", "1.0e+300"), ("[0, 0, 0]", "[1.0e+160, 0, 0]")])
def test_maps_beyond_all_worlds_are_not_imported(workspace: Path, old: str, new: str) -> None:
    Image.new("L", (20, 20), 255).save(workspace / "plan.png")
    (workspace / "map.yaml").write_text(MAP.replace(old, new, 1))
    with pytest.raises(CodedError, match=r"m wide and begins at|resolution"):
        import_map("map.yaml", "a.yaml")


@pytest.mark.parametrize("wrong", [-1, 10, 10**13])
def test_a_proof_with_impossible_counts_is_refused(tmp_path: Path, wrong: int) -> None:
    file = tmp_path / "proof.json"
    file.write_text(json.dumps({"rows": [{"kind": "gold", "operator": "none", "trials": 9, "wrong": wrong}]}))
    with pytest.raises(ArgumentError, match="is not the JSON of a proof"):
        load_proof(file)


@pytest.mark.parametrize("column", [9, 13])
def test_splats_with_huge_logits_and_quaternions(tmp_path: Path, column: int) -> None:
    columns = room(spacing=1.0).columns[:3]
    columns[1, column] = -1e30 if column == 9 else 1e300
    file = write_ply(tmp_path / "room.ply", columns, encoding="ascii")
    if column == 9:
        assert read_splats(file).opacity[1] < 1e-30
    else:
        with pytest.raises(BridgeError, match="quaternion has no direction"):
            read_splats(file)
