"""Lines in the table of a scenario about goals, sensors and beams."""

from __future__ import annotations

from pathlib import Path

from irsim.api.read_input import read_scenario
from irsim.validation.scene_table import scene_table
from irsim.validation.scene_text import scene_lines

WATCH = """\
world: {width: 20, height: 10, step_time: 0.1}
robot:
  - name: watcher
    shape: {name: circle, radius: 0.3}
    state: [1, 5, 0]
    sensors: [{name: fmcw_lidar2d, range_max: 10, angle_range: 2.0943951, number: 241, motion_compensate: true,
               velocity_noise_std: 0.05}]
  - name: parker
    kinematics: {name: omni_angular}
    state: [3, 1, 0]
    goal: [9, 1, 3.14]
    arrive_mode: state
    behavior: {name: dash}
obstacle:
  - {name: box, shape: {name: rectangle, length: 1, width: 4}, state: [6, 5]}
  - name: walker
    kinematics: {name: omni}
    state: [15, 2]
    waypoints: [[15, 8], [12, 8]]
    appear_time: 2.5
    behavior: {name: dash}
"""
SWAP = """\
world: {width: 3, height: 3}
robot:
  - number: 2
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    distribution: {name: random, range_low: [0.4, 0.4, -3.14], range_high: [2.6, 2.6, 3.14]}
    behavior: {name: dash}
  - number: 2
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    distribution: {name: random, range_low: [0.4, 0.4, -3.14], range_high: [2.6, 2.6, 3.14]}
    behavior: {name: dash}
"""


def lines(text: str, tmp_path: Path) -> str:
    file = tmp_path / "scene.yaml"
    file.write_text(text, encoding="utf-8")
    scenario, _ = read_scenario(file, strict=True)
    return "\n".join(scene_lines(scene_table(scenario).model_dump(), {}, 0))


def test_sensors_and_their_beams_are_told(tmp_path: Path) -> None:
    table = lines(WATCH, tmp_path)
    assert "fmcw_lidar2d 120 deg, 10 m, 241 beams, motion_compensate, velocity noise 0.05" in table
    (line,) = [line for line in table.splitlines() if line.startswith("Lidar of 'watcher'")]
    hit, box = int(line.split(": ")[1].split(" of ")[0]), int(line.split("'box' ")[1].split(",")[0])
    assert 0 < box <= hit < 241
    assert abs(box - 241 * 2 * 23.96 / 120) < 3  # the box is seen under atan(2 / 4.5) to both sides


def test_goals_whose_heading_counts_and_waypoints_are_told(tmp_path: Path) -> None:
    table = lines(WATCH, tmp_path)
    assert "goal (9.00, 1.00, 3.14), heading counts" in table
    assert "2 waypoints, first (15.00, 8.00), last (12.00, 8.00)" in table
    assert "appears at 2.5 s" in table


def test_seeds_in_which_goals_overlap_are_counted(tmp_path: Path) -> None:
    assert "overlap" not in lines(SWAP, tmp_path)
    ghosts = SWAP.replace(
        "behavior: {name: dash}", "behavior: {name: dash}, unobstructed: true".replace(", ", "\n    ")
    )
    (line,) = [line for line in lines(ghosts, tmp_path).splitlines() if "overlap" in line]
    assert 0 < int(line.split(" in ")[1].split(" of ")[0]) < 20


DOORS = """\
world: {width: 12, height: 8, boundary: walls}
robot:
  - {name: slim, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [2, 2], goal: [10, 6],
     behavior: {name: dash}}
  - {name: long, kinematics: {name: diff}, shape: {name: rectangle, length: 1.2, width: 0.6}, state: [2, 6, 0],
     waypoints: [[10, 1], [2, 1]], behavior: {name: dash}}
  - {name: homebody, kinematics: {name: omni}, shape: {name: circle, radius: 0.1}, state: [1, 7], goal: [3, 7],
     behavior: {name: dash}}
obstacle:
  - {shape: {name: rectangle, length: 0.2, width: 2.55}, state: [6, 1.275]}
  - {shape: {name: rectangle, length: 0.2, width: 4.55}, state: [6, 5.725]}
"""


def test_the_narrowest_passage_on_the_way_of_each_robot_is_told(tmp_path: Path) -> None:
    told = [line for line in lines(DOORS, tmp_path).splitlines() if "passage" in line]
    assert [line.partition(" at ")[0] for line in told] == [
        "Narrowest passage on the way of 'long': 0.9 m",
        "Narrowest passage on the way of 'slim': 0.9 m",
    ]
    assert "; the robot is 0.6 m wide" in told[0]
    assert "3.00)" in told[1]


def test_the_passage_is_where_the_way_leads_and_not_beside_it(tmp_path: Path) -> None:
    corridor = """\
world: {width: 14, height: 10}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.25}, state: [0.5, 5], goal: [13.5, 5]}
obstacle:
  - {shape: {name: linestring, vertices: [[0, 4.2], [14, 4.2]]}, state: [0, 0, 0]}
  - {shape: {name: linestring, vertices: [[0, 5.8], [14, 5.8]]}, state: [0, 0, 0]}
"""
    assert "Narrowest passage on the way of 'robot_0': 1.6 m" in lines(corridor, tmp_path)
    assert "passage" not in lines(corridor.replace("5.8", "8.8"), tmp_path)


def test_a_passage_in_a_map_and_one_that_is_too_narrow(tmp_path: Path) -> None:
    cells = "world: {width: 6, height: 6, obstacle_map: door.png}\n"
    robot = "robot: {kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [1, 3], goal: [5, 3]}\n"
    from PIL import Image

    picture = Image.new("L", (60, 60), 255)
    picture.paste(0, (29, 0, 31, 25))
    picture.paste(0, (29, 35, 31, 60))
    picture.save(tmp_path / "door.png")
    assert "Narrowest passage on the way of 'robot_0': 1 m at (3" in lines(cells + robot, tmp_path)
    assert "passage" not in lines((cells + robot).replace("radius: 0.3", "radius: 0.6"), tmp_path)


TALK = """\
world: {width: 12, height: 12, zones: [{name: talk, circle: {center: [6, 6], radius: 1.6}}]}
robot: {name: guest, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [6, 1.2, 1.57],
        waypoints: [[6, 10.8], [6, 1.2]], behavior: {name: follow, avoid: [talk]}}
obstacle:
  - {number: 3, shape: {name: circle, radius: 0.25}, state: [[6, 6.8], [5.31, 5.6], [6.69, 5.6]]}
"""


def test_no_passage_is_told_in_a_zone_that_the_robot_avoids(tmp_path: Path) -> None:
    assert "passage" not in lines(TALK, tmp_path)
    through = lines(TALK.replace(", avoid: [talk]", ""), tmp_path)
    assert "Narrowest passage on the way of 'guest': 0.88 m at (6.00, 5.60)" in through.replace("0.89", "0.88")


def test_a_zone_that_the_robot_avoids_is_a_side_of_the_passage_beside_it(tmp_path: Path) -> None:
    wall = "  - {shape: {name: linestring, vertices: [[8.6, 0], [8.6, 12]]}, state: [0, 0, 0]}\n"
    fence = "  - {shape: {name: linestring, vertices: [[0, 6], [5, 6]]}, state: [0, 0, 0]}\n"
    (line,) = [line for line in lines(TALK + wall + fence, tmp_path).splitlines() if "passage" in line]
    assert line.startswith("Narrowest passage on the way of 'guest': 1 m at (8.1")


def test_the_passage_is_that_of_the_route_that_the_robot_plans(tmp_path: Path) -> None:
    """The shortest way leads through the narrow door, the region `within` only through the wide one."""
    inside = DOORS.replace(
        "goal: [10, 6],\n     behavior: {name: dash}", "goal: [10, 2],\n     behavior: {name: follow}"
    )
    inside = inside.replace("length: 0.2, width: 4.55}, state: [6, 5.725]", "length: 0.2, width: 2}, state: [6, 4.45]")
    inside += "  - {shape: {name: rectangle, length: 0.2, width: 1}, state: [6, 7.45]}\n"
    by_name = {line.split("'")[1]: line for line in lines(inside, tmp_path).splitlines() if "passage" in line}
    assert "0.9 m at (" in by_name["slim"]
    upper = inside.replace("{name: follow}", "{name: follow, within: {polygon: [[0, 0], [4, 0], [4, 5], [8, 5], [8, 0],"
                           " [12, 0], [12, 8], [0, 8]]}}")  # fmt: skip
    by_name = {line.split("'")[1]: line for line in lines(upper, tmp_path).splitlines() if "passage" in line}
    assert "1.5 m at (" in by_name["slim"]


CAR = """\
world: {width: 16, height: 10}
robot:
  - name: car
    kinematics: {name: acker}
    shape: {name: rectangle, length: 4.2, width: 1.8, wheelbase: 2.6}
    state: [2.117, 3, 0]
    goal: [12, 7]
    behavior: {name: follow}
    sensors:
      - {name: lidar2d, range_max: 6, angle_range: 2.0, number: 50, offset: [3.4, 0, 0]}
      - {name: contact2d}
      - {name: lidar2d, range_max: 3, angle_range: 2.0, number: 20, offset: [-0.8, 0.2, 3.1416]}
obstacle: {name: box, shape: {name: rectangle, length: 1, width: 1}, state: [8, 3, 0.3]}
"""


def test_each_of_several_sensors_has_its_mounting_pose_and_its_hits(tmp_path: Path) -> None:
    table = lines(CAR, tmp_path)
    assert "sensor 0: lidar2d 115 deg, 6 m, 50 beams, mounted at (+3.40, +0.00) m, sensor 1: contact2d" in table
    assert "sensor 2: lidar2d 115 deg, 3 m, 20 beams, mounted at (-0.80, +0.20) m, turned by +3.14 rad" in table
    front, rear = (line for line in table.splitlines() if " of 'car': " in line)
    assert front.startswith("Sensor 0 of 'car': ")
    assert "'box'" in front
    assert rear == "Sensor 2 of 'car': 0 of 20 beams hit"


def test_the_row_of_a_car_says_where_its_pose_is_and_how_far_its_body_reaches(tmp_path: Path) -> None:
    table = lines(CAR, tmp_path)
    assert "rectangle 4.2 x 1.8 (its pose means the rear axle; body -0.80 to +3.40 m), follow" in table
    assert "'car' at (2.12, 3.00)" in table


def test_ranges_over_seeds_are_told_to_the_centimetre(tmp_path: Path) -> None:
    (line,) = [line for line in lines(SWAP, tmp_path).splitlines() if "'robot_0'" in line]
    assert all(len(value.rpartition(".")[2]) == 2 for value in line.split(" starts x ")[1].split(" y ")[0].split(".."))


def test_the_kinds_of_objects_of_an_entry_have_rows_of_their_own(tmp_path: Path) -> None:
    """Of two objects that differ in more than their places; of many kinds there is one row."""
    fleet = (
        "world: {width: 9, height: 9}\nrobot: {number: 3, kinematics: {name: diff}, state: [[1, 1], [1, 3], [1, 5]], "
        "goal: [8, 8], behavior: [{name: orca}, {name: dash}, {name: orca}], vel_max: [%s]}\n"
    )
    table = lines(fleet % "1, 1", tmp_path)
    assert "- 2 x diff, circle r 1, orca, vel_max [1, 1]: 'robot_0' at (1.00, 1.00)" in table
    assert "; 'robot_2' at (1.00, 5.00)" in table
    assert "- diff, circle r 1, dash, vel_max [1, 1]: 'robot_1' at (1.00, 3.00)" in table
    speeds = ", ".join(f"[{k / 10}, 1]" for k in range(1, 7))
    states = ", ".join(f"[1, {k}]" for k in range(1, 7))
    many = fleet.replace("number: 3", "number: 6").replace("[[1, 1], [1, 3], [1, 5]]", f"[{states}]")
    assert "- 6 x diff" in lines(
        many.replace("[{name: orca}, {name: dash}, {name: orca}]", "{name: dash}") % speeds, tmp_path
    )
