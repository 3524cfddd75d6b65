"""Benchmarks on a Ray cluster of several processes: the files equal a local run's, whatever dies meanwhile."""

from __future__ import annotations

import hashlib
import os
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

import irsim
import irsim.benchmarks
from irsim.api.benchmark_report import write_report
from irsim.benchmarks.cluster import ClusterError
from irsim.benchmarks.plan import file_plan
from irsim.benchmarks.pool import WorkerError
from irsim.benchmarks.stored import run_plan
from tests.benchmarks.cluster.conftest import LocalCluster
from tests.benchmarks.conftest import write_fragile
from tests.skills.conftest import ROOT, fences

pytestmark = [
    pytest.mark.cluster,
    # Ray leaves files and sockets open.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]

SCENE = """\
world: {width: 8, height: 8, obstacle_map: floor.png}
robot: {number: 4, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, distribution: {name: random}}
"""
SEEDS = 30


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a scenario that names a map."""
    monkeypatch.chdir(tmp_path)
    floor = Image.new("L", (40, 40), "white")
    floor.paste(0, (18, 18, 22, 22))
    floor.save("floor.png")
    Path("scene.yaml").write_text(SCENE, encoding="utf-8")
    return tmp_path


def files_of(
    run: str, cluster: str | None = None, workers: int | None = None, then: Callable[[int, int], None] | None = None
) -> dict[str, str]:
    """Hash of each file of a run with its report."""
    plan = file_plan(["scene.yaml"], ["dash", "orca"], str(SEEDS), steps=150)
    run_plan(plan, Path(run), cluster=cluster, workers=workers, progress=then, finish=write_report)
    paths = [path for path in sorted(Path(run).rglob("*")) if path.is_file()]
    assert Path(run, "timing.json").is_file()  # wall-clock times differ from run to run
    kept = [path for path in paths if path.name != "timing.json"]
    return {str(path.relative_to(run)): hashlib.sha256(path.read_bytes()).hexdigest() for path in kept}


def test_auto_starts_a_cluster_and_says_nothing(tmp_path: Path) -> None:
    """First, as long as there is no cluster."""
    (tmp_path / "scene.yaml").write_text(SCENE.replace(", obstacle_map: floor.png", ""), encoding="utf-8")
    environment = {name: value for name, value in os.environ.items() if name != "RAY_ADDRESS"}
    outputs = []
    for words in ([], ["--cluster", "auto", "--workers", "2"]):
        done = subprocess.run(
            [sys.executable, "-m", "irsim", "benchmark", "scene.yaml", "--seeds", "3", "--steps", "30", *words],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        said = [line for line in done.stderr.splitlines() if not line.startswith("simulating: ")]  # after some seconds
        outputs.append((done.returncode, done.stdout, said))
    assert outputs[1] == outputs[0]
    assert outputs[0][0] == 0


def test_files_are_those_of_a_local_run_however_many_processes_there_are(folder: Path, cluster: LocalCluster) -> None:
    local = files_of("local", workers=1)
    assert {"episodes.jsonl", "results.json", "results.html"} <= set(local)
    assert files_of("one", cluster.address, workers=1) == local
    assert files_of("three", cluster.address) == local
    assert files_of("client", cluster.client, workers=2) == local


def test_a_node_that_is_killed_in_the_middle_changes_nothing(folder: Path, cluster: LocalCluster) -> None:
    counts = list[tuple[int, int]]()

    def kill(done: int, total: int) -> None:
        if not counts:
            cluster.cluster.remove_node(cluster.nodes.pop(), allow_graceful=False)
        counts.append((done, total))

    files = files_of("run", cluster.address, then=kill)
    cluster.nodes.append(cluster.cluster.add_node(num_cpus=2))
    assert 0 < counts[0][0] < counts[-1][0] == 2 * SEEDS
    assert files == files_of("local", workers=1)


def test_processes_that_are_killed_in_the_middle_change_nothing(
    folder: Path, cluster: LocalCluster, capfd: pytest.CaptureFixture[str]
) -> None:
    local = irsim.benchmark("scene.yaml", ["dash", "orca"], SEEDS, workers=1, steps=100)
    write_fragile(folder, "fragile", range(3, SEEDS, 9), always=False, here=False)
    result = irsim.benchmark(
        "scene.yaml", ["dash", "orca"], SEEDS, cluster=cluster.address, steps=100, imports=["fragile"]
    )
    assert list(folder.glob("*-*"))
    assert capfd.readouterr() == ("", "")  # Ray would print that they died
    assert (result.episodes, result.rows) == (local.episodes, local.rows)


def test_an_episode_in_which_every_process_dies_is_given_up_and_the_others_are_kept(
    folder: Path, cluster: LocalCluster
) -> None:
    write_fragile(folder, "poisonous", range(7, 8), always=True, here=False)
    with pytest.raises(WorkerError, match=r"3 processes died while they ran scene\.yaml, seed 7, with dash"):
        irsim.benchmark("scene.yaml", "dash", 12, cluster=cluster.address, steps=50, imports=["poisonous"], log="log")
    assert Path("dash-7").read_text().count("x") >= 3
    kept = {row.seed for row in irsim.benchmarks.logged("log").episodes}
    assert kept
    assert 7 not in kept


def test_an_interrupted_run_keeps_what_is_done_and_goes_on(folder: Path, cluster: LocalCluster) -> None:
    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        files_of("run", cluster.address, then=stop)
    kept = Path("run/episodes.jsonl").read_bytes().count(b"\n") - 1
    assert 0 < kept < 2 * SEEDS
    counts = list[tuple[int, int]]()
    plan = file_plan(["scene.yaml"], ["dash", "orca"], str(SEEDS), steps=150)
    run_plan(
        plan, Path("run"), resume=True, cluster=cluster.address, finish=write_report,
        progress=lambda *now: counts.append(now),
    )  # fmt: skip
    assert counts[0][0] > kept
    local = files_of("local", workers=1)
    assert {name: hashlib.sha256(Path("run", name).read_bytes()).hexdigest() for name in local} == local


def test_the_first_error_of_an_episode_is_that_of_a_local_run(folder: Path, cluster: LocalCluster) -> None:
    Path("breaks.py").write_text(
        """\
from irsim.plugins import register_behavior

@register_behavior("diff", "breaks")
def breaks(ego_object, external_objects, **options):
    raise ValueError(f"on purpose at {ego_object.state[0, 0]}")
""",
        encoding="utf-8",
    )
    sys.modules.pop("breaks", None)
    messages = []
    for address in (None, cluster.address):
        with pytest.raises(ValueError, match="on purpose") as error:
            irsim.benchmark("scene.yaml", "breaks", 6, cluster=address, imports=["breaks"])
        messages.append(f"{type(error.value)} {error.value}")
    assert messages[0] == messages[1]


def test_another_version_and_missing_modules_are_found_before_any_episode(
    folder: Path, cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "only_here.py").write_text(f"import os\nassert os.getpid() == {os.getpid()}\n", encoding="utf-8")
    with pytest.raises(ClusterError, match="cannot run what this process can") as error:
        irsim.benchmark("scene.yaml", "dash", 2, cluster=cluster.address, imports=["only_here"], log="log")
    assert error.value.code == "cluster-differs"
    monkeypatch.setattr("irsim.benchmarks.cluster.program", lambda: "99.0, engine 0")
    said = rf"has irsim {irsim.__version__}, engine \w+, and this is irsim 99\.0, engine 0"
    with pytest.raises(ClusterError, match=said):
        irsim.benchmark("scene.yaml", "dash", 2, cluster=cluster.address, log="log")
    assert Path("log").read_bytes().count(b"\n") == 1


def test_a_behavior_that_only_this_program_knows_is_refused(folder: Path, cluster: LocalCluster) -> None:
    from irsim.plugins import register_behavior

    @register_behavior("diff", "known_here")
    def known_here(*words: object, **options: object) -> list[float]:
        return [0.1, 0.0]

    with pytest.raises(ClusterError, match="known_here"):
        irsim.benchmark("scene.yaml", "known_here", 2, cluster=cluster.address)


def test_auto_takes_the_cluster_that_the_environment_names(
    folder: Path, cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("RAY_ADDRESS", cluster.address)
    result = irsim.benchmark("scene.yaml", "dash", 3, steps=20, cluster="auto")
    assert result == irsim.benchmark("scene.yaml", "dash", 3, steps=20, workers=1)
    assert capfd.readouterr() == ("", "")  # Ray is quiet
    assert os.environ["RAY_ADDRESS"] == cluster.address


def test_commands_of_the_skill_work_as_written(tmp_path: Path, cluster: LocalCluster) -> None:
    page = (ROOT / "skills/irsim-benchmark/references/cluster.md").read_text(encoding="utf-8")
    commands = [line for block in fences(page, "bash") for line in block.splitlines()]
    assert len(commands) == 2
    for command in commands:
        words = [sys.executable, "-m", *shlex.split(command)]
        environment = {**os.environ, "RAY_ADDRESS": cluster.address}
        done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "swap" / "results.html").exists()


def test_a_cluster_that_does_not_answer_is_an_error_soon(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import socket

    monkeypatch.setattr("irsim.benchmarks.ray_connection._JOIN_S", 5.0)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(ClusterError, match="did not answer within 5 s"):
            irsim.benchmark("scene.yaml", "dash", 2, cluster=address)
    with pytest.raises(ClusterError, match="refused"):
        irsim.benchmark("scene.yaml", "dash", 2, cluster=f"ray://{address}")
    with pytest.raises(irsim.IrsimError, match="is not the address of a cluster"):
        irsim.benchmark("scene.yaml", "dash", 2, cluster="everything")
