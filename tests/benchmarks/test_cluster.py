"""Work is shared out to a cluster, whose stand-in runs the chunks here. With Ray: tests/benchmarks/cluster."""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from PIL import Image

import irsim
import irsim.benchmarks
from irsim.benchmarks.cluster import ClusterError, _Queue
from irsim.benchmarks.pool import WorkerError
from irsim.common.extras import ExtraError

SCENE = """\
world: {width: 8, height: 8, obstacle_map: floor.png}
robot: {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, distribution: {name: random}}
"""


class Died(Exception):
    pass


class TooLate(Died):
    pass


class Ray:
    """Stand-in: chunks run when they are asked for, end in any order, and may die."""

    exceptions = SimpleNamespace(RayError=Died, GetTimeoutError=TooLate)

    def __init__(self, dies: Callable[[Any], bool] = lambda tasks: False) -> None:
        self.dies, self.sent, self.cancelled = dies, [], 0
        self._order = random.Random(4)

    def put(self, value: Any) -> Any:
        return value

    def remote(self, **options: Any) -> Callable[..., Any]:
        return lambda function: SimpleNamespace(remote=lambda *words: self._submit(function, words))

    def _submit(self, function: Callable[..., Any], words: tuple[Any, ...]) -> Any:
        self.sent.append(words[2])
        return object.__new__(type("Ref", (), {"function": staticmethod(function), "words": words}))

    def wait(self, refs: list[Any], *, num_returns: int, timeout: float) -> tuple[list[Any], list[Any]]:
        return self._order.sample(refs, 1), []

    def get(self, ref: Any, timeout: float | None = None) -> Any:
        if not hasattr(ref, "words"):
            return ref
        if ref.words[2] and self.dies(ref.words[2]):
            raise Died("the node was lost\nwith details")
        return ref.function(*ref.words)

    def cancel(self, ref: Any, *, force: bool) -> None:
        self.cancelled += 1

    def cluster_resources(self) -> dict[str, float]:
        return {"CPU": 3.0}


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[Ray], Ray]:
    """Use a stand-in in place of Ray, in a folder with a scenario."""
    monkeypatch.chdir(tmp_path)
    Image.new("L", (40, 40), "white").save("floor.png")
    Path("scene.yaml").write_text(SCENE, encoding="utf-8")

    def use(ray: Ray) -> Ray:
        @contextmanager
        def connected(address: str, cpus: int) -> Iterator[Ray]:
            yield ray

        monkeypatch.setattr("irsim.benchmarks.cluster.connected", connected)
        monkeypatch.setitem(sys.modules, "ray", ray)
        return ray

    return use


def test_results_are_those_of_a_local_run_in_whatever_order_they_come(use: Callable[[Ray], Ray]) -> None:
    local = irsim.benchmark("scene.yaml", ["dash", "orca"], 8, steps=60, workers=1)
    ray = use(Ray())
    counts: list[tuple[int, int]] = []
    result = irsim.benchmark(
        "scene.yaml", ["dash", "orca"], 8, steps=60, cluster="auto", progress=lambda *now: counts.append(now)
    )
    assert result.model_dump_json() == local.model_dump_json()
    assert counts[-1] == (16, 16)
    assert sorted(task for chunk in ray.sent for task in chunk) == [(job, seed) for job in (0, 1) for seed in range(8)]


def test_maps_travel_with_the_work(use: Callable[[Ray], Ray]) -> None:
    local = irsim.benchmark("scene.yaml", "dash", 3, steps=60, workers=1)

    class Elsewhere(Ray):
        def get(self, ref: Any, timeout: float | None = None) -> Any:
            Path("floor.png").unlink(missing_ok=True)  # what is here is not there
            return super().get(ref, timeout)

    ray = use(Elsewhere())
    assert irsim.benchmark("scene.yaml", "dash", 3, steps=60, cluster="auto") == local
    assert not Path("floor.png").exists()
    assert len(ray.sent) > 1


def test_chunks_that_die_are_run_again_one_by_one(use: Callable[[Ray], Ray], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.benchmarks.cluster._Queue.take", lambda self, cores, plain=_Queue.take: plain(self, 1))
    local = irsim.benchmark("scene.yaml", "dash", 12, steps=20, workers=1)
    seen: list[Any] = []

    def dies(tasks: Any) -> bool:
        seen.append(tasks)
        return len(tasks) > 1 or seen.count(tasks) < 2

    use(Ray(dies))
    assert irsim.benchmark("scene.yaml", "dash", 12, steps=20, cluster="auto") == local
    assert any(len(tasks) > 1 for tasks in seen)


def test_a_task_that_kills_every_process_is_given_up(use: Callable[[Ray], Ray]) -> None:
    ray = use(Ray(lambda tasks: (0, 3) in tasks))
    with pytest.raises(WorkerError, match=r"scene\.yaml, seed 3, with dash \(the node was lost\)"):
        irsim.benchmark("scene.yaml", "dash", 6, steps=20, cluster="auto", log="log")
    assert ray.sent.count([(0, 3)]) == 3
    assert 3 not in {row.seed for row in irsim.benchmarks.logged("log").episodes}


def test_without_ray_the_message_has_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    scene = SCENE.replace(", obstacle_map: floor.png", "")
    with pytest.raises(ExtraError, match=r"ray is not installed.*pip install 'irsim-mcp\[cluster\]'"):
        irsim.benchmark(scene, "dash", 2, cluster="auto")


def test_another_version_is_refused(use: Callable[[Ray], Ray], monkeypatch: pytest.MonkeyPatch) -> None:
    use(Ray())
    monkeypatch.setattr("irsim.benchmarks.cluster.program", lambda: "99.0, engine a")
    with pytest.raises(ClusterError, match=r"and this is irsim 99\.0, engine a") as error:
        irsim.benchmark("scene.yaml", "dash", 2, cluster="auto")
    assert error.value.code == "cluster-differs"


def test_chunks_take_some_seconds_and_become_small_at_the_end() -> None:
    queue = _Queue(10_000)
    assert len(queue.take(10)) == 1  # nothing is known of the time
    queue.took(0.05)
    assert len(queue.take(10)) == 100
    sizes = []
    while chunk := queue.take(10):
        sizes.append(len(chunk))
    assert sizes[-1] == 1
    assert sizes == sorted(sizes, reverse=True)
    assert sum(sizes) == 10_000 - 101
