"""The replay page has what robots believe: poses that they decide from, and the tracks of detectors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs.replay.data import pack_run
from irsim.runs.replay.growing import GrowingRun
from tests.runs.replay.beliefs import SCENE
from tests.runs.replay.conftest import recorded, scene
from tests.runs.replay.reading import data_in, unpacked


def beliefs_of(head: dict[str, Any], columns: dict[str, Any], name: str) -> np.ndarray:
    """(T, 3) where the page has a robot believe to be."""
    [number] = [item["belief"] for item in head["objects"] if item["name"] == name]
    units = (head["quanta"][0], head["quanta"][0], head["quanta"][1])
    return np.stack([columns[key][number] * unit for key, unit in zip(("x", "y", "heading"), units, strict=True)], 1)


def tracks_of(head: dict[str, Any], columns: dict[str, Any]) -> dict[int, list[tuple[float, float, int]]]:
    """Tracks of the only detector by row."""
    assert not columns["seen_detector"].any()
    unit, ends = head["quanta"][0], np.cumsum(columns["seen_count"])
    tracks = list(zip(columns["seen_x"] * unit, columns["seen_y"] * unit, columns["seen_object"].tolist(), strict=True))
    begins = [0, *ends[:-1]]
    return {row: tracks[begin:end] for row, begin, end in zip(columns["seen_row"].tolist(), begins, ends, strict=True)}


def started(folder: Path) -> Any:
    """The environment of the scenario."""
    path = folder / "scene.yaml"
    path.write_text(SCENE)
    return irsim.make(str(path), seed=1, display=False)


def test_beliefs_are_the_poses_that_localization_reports(workspace: Path) -> None:
    run = recorded(SCENE, steps=40)
    readings = run.trace().readings["lost/localization"]
    head, columns = unpacked(pack_run(run).data)
    assert [("belief" in item) for item in head["objects"]] == [True, False]
    believed = beliefs_of(head, columns, "lost")
    assert len(believed) == 41
    for axis, key in enumerate(("x", "y", "theta")):
        assert np.abs(believed[:, axis] - readings[key]).max() <= head["quanta"][axis // 2] + 1e-6
    assert np.abs(believed[:, :2] - run.trace().pose[:, 0, :2]).max() > 0.1


def test_tracks_are_those_of_the_detector_false_ones_too(workspace: Path) -> None:
    run = recorded(SCENE, steps=40)
    table = run.trace().readings["lost/detector"]
    head, columns = unpacked(pack_run(run).data)
    assert head["detectors"] == [0]
    shown = tracks_of(head, columns)
    for row, block in enumerate(table):
        known = block[np.isfinite(block["id"])]
        assert [track[2] for track in shown[row]] == known["object"].tolist()
        for track, one in zip(shown[row], known, strict=True):
            assert track[:2] == pytest.approx((one["x"], one["y"]), abs=1e-3)
    followed = {track[2] for tracks in shown.values() for track in tracks}
    assert followed == {-1, 1}


def test_odometry_is_the_belief_of_a_robot_without_localization(workspace: Path) -> None:
    run = recorded(SCENE.replace("      - {name: localization, position_std: 0.3, heading_std: 0.1, time: 0.5}\n", ""))
    head, columns = unpacked(pack_run(run).data)
    believed = beliefs_of(head, columns, "lost")
    moved, thought = run.trace().pose[-1, 0, 0] - 1, believed[-1, 0] - 1
    assert thought == pytest.approx(moved / 1.2, rel=0.02), "wheels that are larger than believed roll farther"


def test_runs_without_beliefs_and_without_readings_have_none(workspace: Path) -> None:
    head, columns = unpacked(pack_run(recorded(scene())).data)
    assert "detectors" not in head
    assert not any("belief" in item for item in head["objects"])
    assert not any(name.startswith("seen") for name in columns)


def test_beliefs_of_which_the_record_has_only_a_part_are_left_out(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irsim.runs.recorder._MAX_SCANS_BYTES", 30_000)
    run = recorded(SCENE, steps=60)
    assert 0 < len(run.trace().readings["lost/localization"]) < 61
    head, columns = unpacked(pack_run(run).data)
    assert not any("belief" in item for item in head["objects"])
    assert columns["x"].shape == (2, 61)


def test_a_run_that_is_simulated_shows_the_same(workspace: Path) -> None:
    head, columns = unpacked(pack_run(recorded(SCENE, steps=30)).data)
    env = started(workspace)
    growing = GrowingRun(env.simulation, 90)
    first = unpacked(growing.head)
    parts, seen = [first[1]], tracks_of(*first)
    for step in range(1, 31):
        env.step()
        growing.look()
        if step % 10 == 0:
            block = growing.block()
            assert block is not None
            parts.append(unpacked(block)[1])
            rows = sum(len(part["step"]) for part in parts[:-1])
            seen |= {row + rows: tracks for row, tracks in tracks_of(first[0], parts[-1]).items()}
    env.end(0)
    joined = {name: np.concatenate([part[name] for part in parts], axis=1) for name in ("x", "y", "heading")}
    np.testing.assert_allclose(beliefs_of(first[0], joined, "lost"), beliefs_of(head, columns, "lost"), atol=2e-3)
    assert seen == tracks_of(head, columns)


@pytest.mark.parametrize("resets", [0, 2])
def test_a_replay_in_a_notebook_shows_the_same(workspace: Path, resets: int) -> None:
    env = started(workspace)
    for _ in range(resets):
        env.step()
        env.reset()
    growing, reported = GrowingRun(env.simulation, 25), []
    for _ in range(25):
        env.step()
        growing.look()
        reported.append(env.robot.sensors[1].read())
    head, columns = unpacked(data_in(env.replay().text))
    block = growing.block()
    env.end(0)
    assert block is not None
    believed = beliefs_of(head, columns, "lost")
    for axis, key in enumerate(("x", "y", "theta")):
        assert believed[1:, axis] == pytest.approx([one[key] for one in reported], abs=2e-3)
    assert tracks_of(head, columns) == {
        **tracks_of(*unpacked(growing.head)),
        **{row + 1: tracks for row, tracks in tracks_of(head, unpacked(block)[1]).items()},
    }
    assert head["notes"] == []


def test_a_replay_in_a_notebook_names_what_it_cannot_compute_again(workspace: Path) -> None:
    text = """\
world: {width: 10, height: 10, zones: [{name: wet, rectangle: [2, 0, 8, 10], slip: 0.3}]}
robot: {name: lost, kinematics: {name: diff}, state: [1, 5, 0], goal: [9, 5], behavior: {name: dash},
        perceives: estimate, sensors: [{name: odometry}]}
"""
    path = workspace / "wet.yaml"
    path.write_text(text)
    env = irsim.make(str(path), seed=1, display=False)
    pages = []
    for _ in range(2):
        for _ in range(8):
            env.step()
        pages.append(unpacked(data_in(env.replay().text))[0])
    env.end(0)
    assert ["belief" in page["objects"][0] for page in pages] == [True, False]
    assert pages[0]["notes"] == []
    [note] = pages[1]["notes"]
    assert note == "what 'lost/odometry' reported is not shown: the replay cannot compute it again"
