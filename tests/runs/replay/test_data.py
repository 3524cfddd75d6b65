from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim.runs.replay.data as packing
import irsim.runs.replay.rows as rows
from irsim.bundled.templates import names
from irsim.runs import Run, RunError, open_run
from tests.episodes.test_between_steps import scene as tunnel
from tests.runs.replay.conftest import HOSTILE, recorded, scene
from tests.runs.replay.reading import unpacked


def poses_of(head: dict, columns: dict) -> np.ndarray:
    """(T, N, 3) as the page has them."""
    quantum, turn = head["quanta"]
    still = [item["pose"] for item in head["objects"]]
    poses = np.repeat(np.array(still, dtype=float)[None], len(columns["step"]), axis=0)
    for row, item in enumerate(head["objects"]):
        if "track" in item:
            scales = ("x", quantum), ("y", quantum), ("heading", turn)
            poses[:, row] = np.stack([columns[name][item["track"]] * by for name, by in scales], axis=1)
    return poses


def test_poses_are_those_of_the_run(run: Run) -> None:
    trace = run.trace()
    head, columns = unpacked(packing.pack_run(run).data)
    assert columns["step"].tolist() == trace.step.tolist()
    off = poses_of(head, columns) - trace.pose
    assert np.abs(off[:, :, :2]).max() <= head["quanta"][0] / 2 + 1e-4
    turned = np.abs(np.angle(np.exp(1j * off[:, :, 2])))
    assert turned.max() <= head["quanta"][1]
    assert head["quanta"][0] <= 1e-3


def test_objects_events_and_flags(run: Run) -> None:
    head, columns = unpacked(packing.pack_run(run).data)
    named = {item["name"]: item for item in head["objects"]}
    assert [item["role"] for item in head["objects"]] == ["robot"] * 3 + ["obstacle"] * 3
    kinds = {name: next(iter(head["shapes"][item["shape"]])) for name, item in named.items()}
    assert kinds == {
        "rover": "circle", "lorry": "rings", "slider": "rings", "crate": "circle", "wall": "line", "block": "rings",
    }  # fmt: skip
    assert not named["wall"]["seen"]
    assert "track" not in named["crate"]
    told = [(event[1], event[2], event[3]) for event in head["events"]]
    assert [(e.kind, run.names.index(e.object)) for e in run.events] == [event[:2] for event in told]
    assert ("collision", 1, 3) in told
    last = dict(zip(columns["flag_object"].tolist(), columns["flags"].tolist(), strict=True))
    assert last[0] & 1
    assert last[1] & 2
    assert head["outcome"] == "collision"


def test_goals(run: Run) -> None:
    head, columns = unpacked(packing.pack_run(run).data)
    first = columns["goal_row"] == 0
    assert columns["goal_object"][first].tolist() == [0, 1, 2]
    assert columns["goal_set"][first].all()
    np.testing.assert_allclose(columns["goal_x"][first] * head["quanta"][0], [5, 11, 11], atol=1e-3)


def test_scans_are_those_recorded(run: Run) -> None:
    head, columns = unpacked(packing.pack_run(run).data)
    assert head["scans"] == "recorded"
    [lidar] = head["lidars"]
    known = run.trace().ranges["rover/0"]
    shown = columns[lidar["scan"]].T * lidar["quantum"]
    hit = np.isfinite(known) & (known < lidar["range_max"])
    assert hit.any()
    assert np.abs(shown - known)[hit].max() <= lidar["quantum"]
    assert (shown[~np.isfinite(known)] > lidar["range_max"]).all()


def test_scans_that_take_too_much_are_left_to_the_page(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for limit in ("_MAX_RANGES", "_MAX_SCANS_BYTES"):
        with monkeypatch.context() as patch:
            patch.setattr(packing, limit, 100)
            head, columns = unpacked(packing.pack_run(run).data)
        assert head["scans"] == "computed"
        assert not any(name.startswith("scan") for name in columns)


def test_long_runs_are_thinned(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows, "_MAX_POSES", 100)
    head, columns = unpacked(packing.pack_run(run).data)
    steps = columns["step"].tolist()
    assert head["every"] > 1
    assert steps[:2] == [0, head["every"]]
    assert steps[-1] == head["last_step"] == run.last_step


def test_of_too_many_events_collisions_stay_and_others_are_thinned_evenly(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    hit = next(event for event in run.events if event.kind == "collision" and event.object == "lorry")
    times = np.linspace(0, run.last_step, 200).astype(int).tolist()
    arrivals = [hit._replace(kind="arrival", object="rover", partner=None, step=step) for step in times]
    hits = [hit._replace(step=step) for step in times[150:180]]
    other = hit._replace(object="crate", partner="block")
    events = sorted([*arrivals, *hits, other], key=lambda event: event.step)
    monkeypatch.setattr(Run, "events", events)
    monkeypatch.setattr(packing, "MAX_EVENTS", 60)
    head = packing.pack_run(open_run(run.id)).head
    kinds = [event[1] for event in head["events"]]
    assert (kinds.count("collision"), kinds.count("arrival")) == (31, 29)
    shown = [event[0] for event in head["events"] if event[1] == "arrival"]
    assert (shown[0], shown[-1]) == (0, run.last_step)
    assert max(np.diff(shown)) <= 2 * run.last_step / 28
    assert (head["event_count"], head["left_out"]) == (231, {"arrival": 171})
    monkeypatch.setattr(packing, "MAX_EVENTS", 10)
    head = packing.pack_run(open_run(run.id)).head
    assert [event[2] for event in head["events"]] == [1] * 10  # the robot's collisions, over their whole time
    assert (head["events"][0][0], head["events"][-1][0]) == (hits[0].step, hits[-1].step)
    assert head["left_out"] == {"arrival": 200, "collision": 21}


def test_names_are_cleaned(workspace: Path) -> None:
    head = packing.pack_run(recorded(scene(HOSTILE.replace('"', "") + "\\u202e\\x07"), steps=3)).head
    assert all(item["name"].isprintable() and len(item["name"]) <= 80 for item in head["objects"])


def test_a_run_whose_scenario_starts_elsewhere_now_is_refused(run: Run) -> None:
    path = run.folder / "scenario.yaml"
    path.write_text(path.read_text().replace("state: [1, 1, 0]", "state: [2, 1, 0]"))
    with pytest.raises(RunError, match="run it again"):
        packing.pack_run(open_run(run.id))


@pytest.mark.parametrize("name", names())
def test_every_template(workspace: Path, name: str) -> None:
    from irsim.bundled.templates import load

    run = recorded(load(name).text, steps=5)
    head, columns = unpacked(packing.pack_run(run).data)
    recorded_poses = run.trace().pose[:, :, :2]
    there = ~np.isnan(recorded_poses)  # the page knows from which step on an object is there
    np.testing.assert_allclose(poses_of(head, columns)[:, :, :2][there], recorded_poses[there], atol=2e-3)
    if head["grid"] is not None:
        assert int(columns["cells"].sum()) == int(np.prod(head["grid"]["cells"]))


def test_contacts_between_steps_have_their_time_within_the_step(workspace: Path) -> None:
    run = recorded(tunnel())
    head, _ = unpacked(packing.pack_run(run).data)
    number = run.names.index
    graze, through, arrival = head["events"]
    assert graze[:4] == [14, "contact_between_steps", number("runner"), number("post")]
    assert graze[6:] == ["", pytest.approx(1.32, abs=1e-3)]
    assert through[:4] == [24, "passed_through", number("runner"), number("board")]
    assert through[6:] == ["", pytest.approx(2.3133, abs=1e-3)]
    assert len(arrival) == 6


def test_contacts_between_steps_are_among_the_most_important_events(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(packing, "MAX_EVENTS", 2)
    head, _ = unpacked(packing.pack_run(recorded(tunnel())).data)
    assert [event[1] for event in head["events"]] == ["contact_between_steps", "passed_through"]
    assert head["left_out"] == {"arrival": 1}
