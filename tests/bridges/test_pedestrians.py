"""Recorded pedestrians become scenarios whose obstacles are where they were recorded, when they were recorded."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import irsim
from irsim.api.read_input import read_scenario
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.bridges.base import BridgeError
from irsim.bridges.pedestrians.importing import ImportedPedestrians, import_pedestrians
from irsim.bridges.pedestrians.scenario import Layout
from irsim.bridges.pedestrians.suite import Episodes
from irsim.bridges.pedestrians.tracks import Window, read_recording
from irsim.cli.bridge import bridge_app
from irsim.common.files import TargetError
from irsim.diagnostics.errors import ArgumentError
from irsim.env import Env
from irsim.scenario.limits import Limits
from tests.bridges import crowds

pytestmark = pytest.mark.one_python

FILES = {"obsmat.txt": crowds.obsmat, "biwi.txt": crowds.trajnet, "commas.csv": lambda: crowds.trajnet(", ")}


def convert(text: str, name: str = "crowd.txt", **options: Any) -> tuple[Path, ImportedPedestrians]:
    Path(name).write_text(text)
    return Path("scene.yaml"), import_pedestrians(name, "scene.yaml", **options)


def replayed(scene: Path) -> dict[str, dict[int, tuple[float, float]]]:
    """Name -> step -> place of the obstacles, as simulated, while they are in the world."""
    places: dict[str, dict[int, tuple[float, float]]] = {}
    env = irsim.make(str(scene), headless=True, log_level="ERROR")
    for step in range(100):
        for item in env.obstacle_list:
            x, y = item.state[:2, 0].tolist()
            if x == x:
                places.setdefault(item.name, {})[step] = (x, y)
        env.step()
    return places


@pytest.mark.parametrize("smooth", ["linear", "cubic"])
@pytest.mark.parametrize("name", FILES)
def test_places_at_recorded_times_are_exact(name: str, smooth: str) -> None:
    scene, imported = convert(FILES[name](), name, layout=Layout(name, interpolation=smooth))
    assert imported.format == ("obsmat" if name == "obsmat.txt" else "trajnet")
    assert (imported.pedestrians, imported.fps, imported.duration) == (3, 15.0, pytest.approx(7.6))
    assert [item.message for item in irsim.validate(str(scene)).findings if item.severity == "error"] == []
    obstacles = replayed(scene)
    assert set(obstacles) == {f"ped_{who}" for who in crowds.walks()}
    for who, way in crowds.walks().items():
        places = obstacles[f"ped_{who}"]
        assert (min(places), max(places)) == (4 * way[0][0], 4 * way[-1][0]), "it is there as long as it was recorded"
        recorded = np.array([(x, y) for _, x, y in way])
        np.testing.assert_allclose([places[4 * row] for row, _, _ in way], recorded, atol=1e-9)


@pytest.mark.parametrize("mapped", ["scale", "homography", "corner"])
def test_splines_in_pixels(mapped: str) -> None:
    matrix = np.diag([0.02, 0.02, 1.0])
    if mapped == "corner":  # counts from the upper left corner of a picture of 720 x 576, y downwards
        matrix = matrix @ np.array([[1, 0, -360], [0, -1, 288], [0, 0, 1.0]])
    np.savetxt("H.txt", 3.0 * matrix)
    options: dict[str, Any] = {"scale": 0.02} if mapped == "scale" else {"homography": "H.txt"}
    if mapped == "corner":
        options["image_size"] = (720, 576)
    scene, imported = convert(crowds.vsp(), "crowd.vsp", **options)
    assert (imported.format, imported.pedestrians, imported.fps) == ("vsp", 3, 25.0)
    places = replayed(scene)
    for number, way in enumerate(crowds.walks().values()):
        for row, x, y in way:
            assert places[f"ped_{number}"][4 * row] == pytest.approx((x, y), abs=1e-9)


def test_a_run_with_a_robot() -> None:
    scene, _ = convert(crowds.trajnet(), layout=Layout("x", start=(-4, 3), goal=(5, 3)))
    assert irsim.run(str(scene)).robots[0].name == "robot"
    assert not irsim.validate(str(scene)).findings


@pytest.mark.parametrize("way", [0.4, 0.0])
def test_a_robot_does_not_start_in_a_person(way: float) -> None:
    scene, _ = convert("\n".join(f"{10 * row} 1 {way * row:g} 0" for row in range(10)))
    assert irsim.run(str(scene), seed=1, steps=20).outcome != "collision", (
        "it started beside the one who stands or walks where it would have started"
    )


def test_a_table_may_begin_with_the_names_of_its_columns() -> None:
    text = crowds.trajnet(", ")
    plain = convert(text)[0].read_text()
    for header in ("frame,id,x,y", "frame_id, ped_id, x, y", "Frame, TrackID, X, Y"):
        assert convert(f"{header}\n{text}", overwrite=True)[0].read_text() == plain
    with pytest.raises(BridgeError, match=r"line 1 of .* has 'id' instead of a number"):
        convert(f"id,frame,x,y\n{text}", overwrite=True)


def test_a_long_time_without_rows_is_told() -> None:
    rows = [f"{frame} {who} {frame / 10} {who}" for frame in (0, 10, 20, 400, 410) for who in (1, 2)]
    assert any("has no row for 15.2 s" in note for note in convert("\n".join(rows))[1].notes)
    assert not any("no row" in note for note in convert(crowds.trajnet(), overwrite=True)[1].notes)


def test_windows_of_time_and_space() -> None:
    scene, imported = convert(crowds.trajnet(), window=Window(start=4.0, end=6.0), layout=Layout("x", robot=False))
    assert imported.duration == pytest.approx(2.0)
    places = replayed(scene)
    assert places["ped_1"][0] == pytest.approx(crowds.walks()[1][10][1:], abs=1e-9)
    scene, imported = convert(crowds.trajnet(), window=Window(box=(-10, -10, 2.9, 10)), overwrite=True)
    assert imported.pedestrians == 2, "who leaves the area vanishes"
    assert max(x for x, _ in replayed(scene)["ped_1"].values()) <= 2.9


def test_who_comes_back_into_the_area_is_another_obstacle() -> None:
    rows = [f"{10 * k} 5 {x} 0" for k, x in enumerate([0, 1, 5, 5, 1, 0, 5, 0])]
    scene, imported = convert("\n".join(rows), window=Window(box=(-1, -1, 2, 1)))
    assert imported.pedestrians == 2
    assert "1 with a single row" in " ".join(imported.notes)
    assert set(replayed(scene)) == {"ped_5", "ped_5_2"}


def test_frame_rates() -> None:
    _, slow = convert("0 1 0 0\n10 1 1 0\n20 1 2 0\n40 1 3 0\n")
    assert slow.fps == pytest.approx(25.0)
    assert "--fps" in " ".join(slow.notes)
    _, given = convert("0 1 0 0\n10 1 1 0\n", fps=30.0, overwrite=True)
    assert given.duration == pytest.approx(1 / 3)
    assert "between steps" in " ".join(given.notes)


@pytest.mark.parametrize(
    ("text", "name", "expected"),
    [
        ("", "a.txt", "is empty"),
        ("# only a comment\n\n", "a.txt", "is empty"),
        ("0 1 0 0\n1 1 nan 0\n", "a.txt", "line 2 .*'nan', which is not finite"),
        ("0 1 0 0\n\n1 1 0 -inf\n", "a.txt", "line 3 .*not finite"),
        ("0 1 0 0\n1 1e300 0 0\n", "a.txt", "line 2 .*too large"),
        ("0 1.5 0 0\n", "a.txt", "line 1 .*not whole"),
        ("0 1 0 0\n1 1 0 2e9\n", "a.txt", "line 2 .*too far away"),
        ("0 1 0 0\n1 1 0\n", "a.txt", "line 2 .*3 columns instead of 4 numbers"),
        ("0 1 0\n", "a.txt", "line 1 .*3 columns, and files of pedestrians have 4 or 8"),
        ("0 1 0 0 0 0 0 0\n1 1 0 0\n", "a.txt", "line 2 .*instead of 8 numbers"),
        ("frame id x y\n", "a.txt", "is empty"),
        ("0 1 0 0\n0 1 2 0\n", "a.txt", "person 1 is at two places in frame 0"),
        ("0 1 0 0\n1e12 1 2 0\n1e12 2 2 0\n1000000000001 2 2 0", "a.txt", "lasts"),
        ("0 1 0 0\n", "a.txt", "no pedestrian"),
        ("\x00\x01\x02" * 2000, "a.txt", "line 1 .*longer than"),
        ("2 - the number of splines\n1 - Num of control points\n0 0 0 0\n", "a.vsp", "ends before spline 2 of 2"),
        ("1 - the number of splines\n9 - Num\n0 0 0 0\n", "a.vsp", "ends before point 2 of 9 of spline 1"),
        ("999999999 - the number of splines\n", "a.vsp", "ends before spline 1"),
        ("99999999999999999999 - splines\n", "a.vsp", "line 1 .*count"),
        ("-1 - splines\n", "a.vsp", "line 1 .*count"),
        ("1 - splines\n1 - points\n0 0 0\n", "a.vsp", "line 3 .*3 columns"),
        ("", "a.vsp", "ends before the number of splines"),
    ],
)
def test_bad_files_are_refused_and_nothing_is_written(text: str, name: str, expected: str) -> None:
    with pytest.raises(BridgeError, match=expected) as caught:
        convert(text, name, scale=1.0)
    assert caught.value.code == "bridge-file"
    assert [str(path) for path in Path().iterdir()] == [name]


def test_endless_files_are_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    huge = Path("huge.txt")
    with open(huge, "wb") as file:
        file.truncate(20_000_000_000)  # sparse: 1e9 lines of 20 characters
    since = time.perf_counter()
    with pytest.raises(BridgeError, match="more than 134 MB"):
        read_recording(huge)
    assert time.perf_counter() - since < 1
    huge.unlink()
    monkeypatch.setattr("irsim.bridges.pedestrians.tracks._MAX_LINES", 1000)
    Path("many.txt").write_text("\n" * 2000)
    with pytest.raises(BridgeError, match="line 1001"):
        read_recording(Path("many.txt"))
    monkeypatch.setattr("irsim.bridges.pedestrians.tracks._MAX_ROWS", 10)
    Path("rows.txt").write_text("".join(f"{k} 1 0 0\n" for k in range(20)))
    with pytest.raises(BridgeError, match="row 11"):
        read_recording(Path("rows.txt"))
    for path in (Path(), Path("none.txt"), Path("/dev/zero")):
        with pytest.raises(BridgeError, match=r"not a file|cannot be read"):
            read_recording(path)


def test_more_rows_than_a_scenario_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.bridges.pedestrians.scenario.DEFAULT_LIMITS", Limits(events=100))
    with pytest.raises(BridgeError, match="3 pedestrians with 33 rows are more than a file may hold"):
        convert(crowds.trajnet())


def test_options_that_do_not_fit() -> None:
    with pytest.raises(ArgumentError, match="pixels"):
        convert(crowds.vsp(), "crowd.vsp")
    with pytest.raises(ArgumentError, match="fps"):
        convert(crowds.trajnet(), fps=-3.0)
    for matrix in ("1 2 3\n4 5 6\n", "1 0 0\n0 1 0\n0 1 0\n"):
        Path("H.txt").write_text(matrix)
        with pytest.raises(BridgeError, match="not a homography"):
            convert(crowds.vsp(), "crowd.vsp", homography="H.txt")
    scene, _ = convert(crowds.trajnet())
    before = scene.read_text()
    with pytest.raises(TargetError, match="exists"):
        convert(crowds.trajnet(), window=Window(end=3.0))
    assert scene.read_text() == before


@pytest.fixture(scope="module")
def square(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("recorded") / "square.txt"
    path.write_text(crowds.square())
    return path


def test_a_suite_of_windows(square: Path) -> None:
    imported = import_pedestrians(square, suite="my crowd.yaml", episodes=Episodes(length=20))
    assert (imported.file, imported.length, imported.notes[1:]) == (None, 20, [])
    assert imported.windows == pytest.approx([0, 20, 40, 60, 80, 100])
    plan = suite_plan("my crowd.yaml", policies=["orca", "sfm"], seeds=2)
    result = measure_plan(plan, workers=1)
    assert result.scenarios == [f"from-{start}s" for start in (0, 20, 40, 60, 80, 100)]
    assert (plan.name, len(result.episodes)) == ("my_crowd", 6 * 2 * 2)
    orca = next(row for row in result.rows if row.scenario == "(all)")
    assert orca.success.rate > 0.8
    again = measure_plan(plan, workers=1)
    assert again.episodes == result.episodes


def test_windows_have_the_people_of_their_time(square: Path) -> None:
    window = Window(10.0, 110.0)
    imported = import_pedestrians(square, suite="s.yaml", window=window, episodes=Episodes(length=25))
    scenarios = yaml.safe_load(Path("s.yaml").read_text())["scenarios"]
    recorded = np.loadtxt(square)
    assert len(scenarios) == 4
    for scenario, start in zip(scenarios, imported.windows, strict=True):
        since = start + 10
        assert scenario["name"] == f"from-{since:g}s"
        (people,) = scenario["scenario"]["obstacle"]
        for name, behavior in zip(people["name"], people["behavior"], strict=True):
            mine = recorded[recorded[:, 1] == int(name.removeprefix("ped_"))]
            times = mine[:, 0] / crowds.FRAME_STEP * crowds.PERIOD
            inside = (times >= since - 1e-6) & (times <= since + 25 + 1e-6)
            np.testing.assert_allclose(behavior["times"], times[inside] - since, atol=1e-6)
            np.testing.assert_allclose(behavior["poses"], mine[inside, 2:])


def test_seeds_draw_free_starts_and_goals_far_apart(square: Path) -> None:
    import_pedestrians(square, suite="s.yaml", episodes=Episodes(length=40))
    scenario, _ = read_scenario(Path("s.yaml/from-40s"), strict=True)
    ways = []
    for seed in range(20):
        env = Env(scenario, seed=seed, headless=True, log_level="ERROR")
        start, goal = env.robot.state[:2, 0], env.robot.goal[:2, 0]
        people = [item.state[:2, 0] for item in env.obstacle_list if np.isfinite(item.state[0, 0])]
        ways.append((*start, *goal))
        assert len(people) > 3
        assert np.hypot(*(goal - start)) >= 0.6 * 16
        for ends, room in ((start, 0.25 + 0.5), (goal, 0.0)):
            assert np.abs(ends[0]) < 9
            assert np.abs(ends[1]) < 6
            assert min(np.hypot(*(ends - place)) for place in people) > 0.3 + room
        env.end(ending_time=0.0)
    assert len(set(ways)) == 20, "each seed draws another way"


def test_a_seed_chooses_the_windows(square: Path) -> None:
    def windows(seed: int, count: int = 3) -> tuple[list[float], str]:
        episodes = Episodes(count, 10.0, seed)
        imported = import_pedestrians(square, suite="s.yaml", episodes=episodes, overwrite=True)
        return imported.windows, Path("s.yaml").read_text()

    starts, text = windows(0)
    assert len(starts) == 3
    assert starts == sorted(starts)
    assert windows(0) == (starts, text)
    assert len({tuple(windows(seed)[0]) for seed in range(6)}) > 2
    assert len(windows(0, 100)[0]) == 13


def test_a_recording_that_is_shorter_than_a_window(square: Path) -> None:
    window = Window(0.0, 10.0)
    imported = import_pedestrians(square, suite="s.yaml", window=window, episodes=Episodes(length=60))
    assert imported.windows == [0.0]
    assert "ends before the only window" in imported.notes[0]
    assert len(measure_plan(suite_plan("s.yaml", seeds=2), workers=1).episodes) == 3 * 2


def test_options_of_suites_that_do_not_fit(square: Path) -> None:
    for episodes, expected in ((Episodes(0), "windows"), (Episodes(201), "at most 200"), (Episodes(1, -1.0), "length")):
        with pytest.raises(ArgumentError, match=expected):
            import_pedestrians(square, suite="s.yaml", episodes=episodes)
    for targets in ({}, {"out": "s.yaml", "suite": "s.yaml"}):
        with pytest.raises(ArgumentError, match="a scenario or a suite"):
            import_pedestrians(square, **targets)
    Path("old.yaml").write_text("mine")
    with pytest.raises(TargetError, match="exists"):
        import_pedestrians(square, "new.yaml", suite="old.yaml")
    assert [path.name for path in Path().iterdir()] == ["old.yaml"], "neither file is written"
    for layout, expected in ((Layout("x", behavior="rov"), "did you mean rvo"), (Layout("x", margin=-1.0), "margin")):
        with pytest.raises(ArgumentError, match=expected):
            import_pedestrians(square, "s.yaml", layout=layout)
    with pytest.raises(BridgeError, match="no pedestrian"):
        import_pedestrians(square, suite="s.yaml", window=Window(box=(100, 100, 101, 101)))


def test_the_command() -> None:
    Path("obsmat.txt").write_text(crowds.obsmat())
    arguments = ["import-pedestrians", "obsmat.txt", "-o", "scene.yaml", "--end", "5", "--json", "--robot-start=-4,3",
                 "--robot-goal=5,3", "--smooth"]  # fmt: skip
    done = CliRunner().invoke(bridge_app, arguments)
    assert done.exit_code == 0, done.output
    answer = json.loads(done.stdout)
    assert (answer["format"], answer["pedestrians"]) == ("obsmat", 3)
    assert "interpolation: cubic" in Path("scene.yaml").read_text()
    refused = CliRunner().invoke(bridge_app, [*arguments, "--force", "--crop", "1,2,3"])
    assert refused.exit_code == 2


@pytest.mark.foreign
@pytest.mark.parametrize(
    ("name", "people", "unknown"),
    [
        ("eth_obsmat", 360, 0),
        ("hotel_obsmat", 389, 0),
        ("trajectron_zara01", 148, 0),
        ("trajnet_test_zara01", None, 1),
    ],
)
def test_recordings_of_others(foreign: Path, name: str, people: int | None, unknown: int) -> None:
    imported = import_pedestrians(foreign / "pedestrians" / f"{name}.txt", "scene.yaml")
    assert people in (imported.pedestrians, None)
    assert any("rows without a place (?)" in note for note in imported.notes) == bool(unknown)
    assert [one.code for one in irsim.validate("scene.yaml").findings if one.code == "stacked"] == []
