"""Every kind of file that a user brings: an example, and the function that reads it."""

from __future__ import annotations

import functools
import random
import shutil
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
import yaml
from PIL import Image

import irsim
from irsim.api.audit_submission import audit_submission
from irsim.benchmarks.log import Log, logged
from irsim.benchmarks.plan import file_plan
from irsim.benchmarks.stored import read_plan
from irsim.benchmarks.suite import load_suite
from irsim.benchmarks.suite_scenarios import expand
from irsim.bridges.json_lines.bridge import JsonLinesBridge
from irsim.bridges.maps.importing import import_map
from irsim.bridges.maps.kinds._gltf import open_scene as open_gltf
from irsim.bridges.maps.sidecar import read_sidecar
from irsim.bridges.pedestrians.importing import import_pedestrians
from irsim.bridges.pedestrians.tracks import read_homography
from irsim.bridges.splats.reading import read_splats
from irsim.components.bridges.json_lines import JsonLines
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.tasks.files import open_task
from irsim.learning.tasks.scene import open_scene
from irsim.learning.training.run_folder import RunFolder
from irsim.learning.training.settings import TrainingSettings, read_settings
from irsim.policies.catalog import open_policy
from irsim.policies.converters.convert import parse_options
from irsim.policies.converters.torch_files.reader import read_torch
from irsim.policies.networks import save_network
from irsim.policies.neupan import NeuPanPolicy
from irsim.policies.process.messages import PeerError, answer, declaration
from irsim.runs.audit.audit import audit_runs
from irsim.runs.comparison import diff_runs
from irsim.runs.files import RunError
from irsim.runs.inspection import FIELDS, inspect_run
from irsim.runs.reading import open_run
from irsim.runs.replay.data import pack_run
from irsim.scenario.limits import Limits
from irsim.scenario.open import open_scenario
from irsim_evals.grader.artefact import cost_of
from tests.benchmarks.conftest import SUITE
from tests.bridges import crowds
from tests.bridges.maps import scenes
from tests.bridges.maps.test_roads import road
from tests.bridges.splats import scenes as splat_scenes
from tests.fuzz.damaged.kind import IMPORT, Kind, made, read_map_of, text
from tests.fuzz.damaged.places import PLACES, ROS_MAP
from tests.fuzz.damaged.verdicts import VERDICTS
from tests.learning.tasks import corridor
from tests.policies.converters import torch_bytes
from tests.policies.networks.examples import go_to_goal
from tests.runs.conftest import ROOM

__all__ = ["KINDS"]

_LIMITS = Limits(cells=250_000, map_bytes=1 << 20, objects=60, robots=60, steps=50)
_HALL = "world: {width: 10, height: 10, obstacle_map: FILE}\nrobot: {kinematics: {name: diff}, state: [1, 1]}\n"
_ROADS = f'<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="7"/>{road("<line/>")}</OpenDRIVE>'
_NEUPAN = (
    "mpc: {receding: 10}\nrobot: {kinematics: diff, length: 1.6, width: 2.0, max_speed: [8, 1]}\n"
    "pan: {iter_num: 2, dune_checkpoint: model.pth}\nadjust: {q_s: 1.0}\nref_speed: 4\n"
)


def _read_scenario(file: Path, draw: random.Random) -> None:
    open_scenario(str(file), limits=_LIMITS)


def _plan() -> Image.Image:
    grey = np.full((20, 20), 255, dtype=np.uint8)
    grey[5:9, 3:17] = np.random.default_rng(0).integers(0, 255, (4, 14), dtype=np.uint8)
    return Image.fromarray(grey)


def _picture(ending: str, mode: str = "L") -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        _plan().convert(mode).save(folder / f"plan.{ending}")
        (folder / "hall.yaml").write_text(_HALL.replace("FILE", f"plan.{ending}"))
        return folder / f"plan.{ending}"

    return make


def _map_file(folder: Path) -> Path:
    _plan().save(folder / "plan.png")
    (folder / "hall.yaml").write_text(_HALL.replace("FILE", "{name: ros, path: map.yaml}"))
    (folder / "map.yaml").write_text(ROS_MAP)
    return folder / "map.yaml"


def _read_map(file: Path, draw: random.Random) -> None:
    open_scenario(str(file.with_name("hall.yaml")), limits=_LIMITS)


def _run(name: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        (folder / "room.yaml").write_text(ROOM, encoding="utf-8")
        irsim.run(folder / "room.yaml", record=folder / "run")
        shutil.copytree(folder / "run", folder / "same")
        return folder / "run" / name

    return make


def _audit_run(file: Path, draw: random.Random) -> None:
    for problem in audit_runs([file.parent]).runs[0].problems:
        raise RunError(problem.code, problem.message)


def _audit_submission(file: Path, draw: random.Random) -> None:
    assert not audit_submission(file.parent).equal  # the files that it names are missing


def _read_run(file: Path, draw: random.Random) -> None:
    run = open_run(file.parent)
    look = draw.randrange(12)
    if look < 6:
        view = ("rows", "collisions", "speeds", "zones", "sight", "closest")[look]
        inspect_run(run, view=view, robot="all" if look % 2 else None, fields=FIELDS)
    elif look < 8:
        diff_runs(run, open_run(file.parent.with_name("same")))
    elif look < 9:
        pack_run(run, limits=_LIMITS)
    else:
        _ = run.result, run.events, run.resolved, run.notes, run.extent, run.files(), run.status, run.trace()


def _log(folder: Path) -> Path:
    (folder / "room.yaml").write_text(ROOM, encoding="utf-8")
    irsim.benchmark(folder / "room.yaml", "dash", seeds=[1, 2], steps=3, log=folder / "log.jsonl")
    return folder / "log.jsonl"


def _read_log(file: Path, draw: random.Random) -> None:
    Log.known(file, logged(file).model_copy(update={"rows": [], "episodes": [], "notes": [], "incidents": []}))


def _training(name: str) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        task, place = open_task(corridor())
        RunFolder(folder / "run").begin(task, place, {}, TrainingSettings())
        (folder / "run" / "progress.jsonl").write_text('{"learners": 0.9, "reward": 5.0}\n{"learners": 1}\n')
        return folder / "run" / name

    return make


def _read_task(file: Path, draw: random.Random) -> None:
    open_scene(*open_task(file))


def _read_pedestrians(file: Path, draw: random.Random) -> None:
    import_pedestrians(
        file, file.with_name("scene.yaml"), scale=0.02 if file.suffix == ".vsp" else None, overwrite=True
    )


def _torch(old: bool) -> Callable[[Path], Path]:
    values = np.arange(6, dtype="<f4").tobytes()
    body = torch_bytes.mapping(
        {"net.weight": torch_bytes.tensor("0", (2, 3)), "net.bias": torch_bytes.tensor("1", (2,))}
    )
    if old:
        content = torch_bytes.old_file(body, {"0": (6, values), "1": (2, values[:8])})
    else:
        content = torch_bytes.zip_file(body, {"0": values, "1": values[:8]})
    return made(lambda file: file.write_bytes(content), "net.pt")


def _read_torch(file: Path, draw: random.Random) -> None:
    read_torch(file)


def _plan_file(folder: Path) -> Path:
    (folder / "room.yaml").write_text(ROOM, encoding="utf-8")
    plan = file_plan([str(folder / "room.yaml")], ["dash"], [1], steps=2)
    (folder / "plan.json").write_text(plan.model_dump_json(indent=1) + "\n")
    return folder / "plan.json"


def _read_plan(file: Path, draw: random.Random) -> None:
    read_plan(file.parent)


def _splats(encoding: str) -> Callable[[Path], Path]:
    columns = splat_scenes.room(spacing=1.0).columns[:40]
    return made(lambda file: splat_scenes.write_ply(file, columns, encoding=encoding), "room.ply")


def _mesh_set() -> bytes:
    return scenes.mesh_set(scenes.tile([(0, 0, 4, 3, 0), (4, 1, 5, 2, 0)]))


def _sidecar(folder: Path) -> Path:
    (folder / "room.navmesh").write_bytes(_mesh_set())
    import_map(folder / "room.navmesh", folder / "scene.yaml")
    return folder / "scene.bridge.json"


def _snapshot(folder: Path) -> Path:
    """A snapshot of an environment with noise, in the folder of its scenario."""
    (folder / "room.yaml").write_text(ROOM, encoding="utf-8")
    (folder / "snapshot").write_bytes(_taken(folder / "room.yaml").snapshot())
    return folder / "snapshot"


@functools.cache
def _taken(scenario: Path) -> irsim.Env:
    return irsim.make(scenario, seed=1, display=False)


def _restore(file: Path, draw: random.Random) -> None:
    env, content = _taken(file.with_name("room.yaml")), file.read_bytes() if file.is_file() else b""
    env.restore(content)
    env.step()


def _read_words(file: Path, draw: random.Random) -> None:
    word = "rate=" + (file.read_bytes() if file.is_file() else b"").decode("latin-1")
    parse_options([word])
    with suppress(ArgumentError):
        read_settings({}, [word])


def _read_feedback(file: Path, draw: random.Random) -> None:
    JsonLinesBridge(JsonLines(name="json_lines"))._read(file.read_bytes() if file.is_file() else b"")


def _read_answer(file: Path, draw: random.Random) -> None:
    with suppress(PeerError):
        declaration(answer(file.read_bytes() if file.is_file() else b"", "hello"))


_MANIFEST = """{"format": 1, "suite": "x", "suite_version": 1, "suite_hash": "a", "plan_hash": "b", "irsim": "0.1.0",
 "python": "3.11", "numpy": "2.4", "platform": "any", "engine": "c", "core": "d",
 "policies": {"dash": "d"}, "seeds": [1],
 "episodes": 1, "sample": [{"scenario": "a", "policy": "dash", "seed": 1, "folder": "runs/00"}],
 "files": {"plan.json": "e", "results.json": "f", "runs/00/run.json": "a"}}"""
_RUN_FILES = ("run.json", "resolved.json", "result.json", "scenario.yaml", "trace-0000.npz")
KINDS: Mapping[str, Kind] = {
    "scenario": Kind(text("room.yaml", ROOM), _read_scenario),
    "map-yaml": Kind(_map_file, _read_map),
    "png": Kind(_picture("png"), _read_map),
    "png-palette": Kind(_picture("png", "P"), _read_map),
    "pgm": Kind(_picture("pgm"), _read_map),
    "tiff": Kind(_picture("tiff"), _read_map),
    "jpeg": Kind(_picture("jpg"), _read_map),
    "bmp": Kind(_picture("bmp"), _read_map),
    "gif": Kind(_picture("gif"), _read_map),
    "neupan": Kind(text("planner.yaml", _NEUPAN, **{"model.pth": ""}), lambda file, draw: NeuPanPolicy(str(file))),
    "suite": Kind(text("suite.yaml", SUITE), lambda file, draw: expand(*load_suite(str(file))), share=4),
    "task": Kind(made(lambda file: file.write_text(yaml.safe_dump(corridor())), "task.yaml"), _read_task, share=2),
    "settings": Kind(_training("settings.yaml"), lambda file, draw: RunFolder(file.parent).settings()),
    "progress": Kind(_training("progress.jsonl"), lambda file, draw: RunFolder(file.parent).rounds()),
    "key-value": Kind(text("word", "0.5"), _read_words),
    **{f"run-{name.partition('.')[0]}": Kind(_run(name), _read_run) for name in _RUN_FILES},
    **{f"audit-{name.partition('.')[0]}": Kind(_run(name), _audit_run) for name in _RUN_FILES},
    "submission": Kind(text("submission.json", _MANIFEST), _audit_submission),
    "benchmark-log": Kind(_log, _read_log),
    "policy": Kind(made(lambda file: save_network(file, go_to_goal()), "net.npz"),
                   lambda file, draw: open_policy(str(file))),
    "torch": Kind(_torch(old=False), _read_torch),
    "torch-old": Kind(_torch(old=True), _read_torch),
    "plan": Kind(_plan_file, _read_plan),
    "navmesh": Kind(made(lambda file: file.write_bytes(_mesh_set()), "room.navmesh"), read_map_of, share=2),
    "roads": Kind(made(lambda file: file.write_text(_ROADS), "town.xodr"), read_map_of, share=4),
    "gltf": Kind(made(lambda file: scenes.write_glb(file, scenes.box([0, 0, 0], [1, 1, 1])), "scene.glb"),
                 lambda file, draw: file.is_file() and open_gltf(file, IMPORT)),
    "splats": Kind(_splats("binary_little_endian"), lambda file, draw: read_splats(file, harmonics=True)),
    "splats-text": Kind(_splats("ascii"), lambda file, draw: read_splats(file)),
    "sidecar": Kind(_sidecar, lambda file, draw: read_sidecar(file)),
    "feedback": Kind(text("line", '{"version": 1, "poses": {"rover": [1, 2.5, 0]}, "ranges": {"a": [1, null]}}'),
                     _read_feedback),
    **PLACES,
    **VERDICTS,
    "snapshot": Kind(_snapshot, _restore),
    "calls": Kind(text("calls.jsonl", '{"tool": "run_episode", "error": false, "tokens": 12}\n' * 2),
                  lambda file, draw: cost_of(file)),
    "obsmat": Kind(text("obsmat.txt", crowds.obsmat()), _read_pedestrians, share=2),
    "trajnet": Kind(text("crowd.txt", crowds.trajnet()), _read_pedestrians, share=2),
    "vsp": Kind(text("crowd.vsp", crowds.vsp()), _read_pedestrians, share=2),
    "homography": Kind(text("H.txt", "0.02 0 1\n0 0.02 -2\n0 0 1\n"), lambda file, draw: read_homography(file)),
    "answer": Kind(text("line", '{"type": "hello", "protocol": 1, "name": "far", "needs": {"scan": true}}'),
                   _read_answer),
}  # fmt: skip
