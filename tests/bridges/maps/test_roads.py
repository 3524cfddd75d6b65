"""Roads of OpenDRIVE: geometries against curves that are worked out otherwise, lanes, and files that are refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map, read_sidecar
from irsim.bridges.maps.kinds.opendrive import read_roads, reference_line

LANES = """<lanes><laneSection s="0">
<left><lane id="1" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane></left>
<center><lane id="0" type="none"/></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="3" b="0" c="0" d="0"/></lane>
<lane id="-2" type="shoulder"><width sOffset="0" a="1" b="0" c="0" d="0"/></lane></right>
</laneSection></lanes>"""


def road(shape: str, length: float = 20, *, lanes: str = LANES, heading: float = 0, more: str = "") -> str:
    where = f'<geometry s="0" x="10" y="5" hdg="{heading}" length="{length}">{shape}</geometry>'
    return f'''<road name="" length="{length}" id="7" junction="-1"><planView>
{where}</planView>{more}{lanes}</road>'''


def write(*roads: str, head: str = '<?xml version="1.0"?>') -> Path:
    file = Path("town.xodr")
    file.write_text(f'{head}<OpenDRIVE><header revMajor="1" revMinor="7"/>{"".join(roads)}</OpenDRIVE>')
    return file


def line(shape: str, s: np.ndarray, **keys) -> np.ndarray:
    [one] = read_roads(write(road(shape, **keys)))
    return np.column_stack(reference_line(one, s))


def test_lines_and_arcs() -> None:
    s = np.linspace(0, 20, 9)
    straight = line("<line/>", s, heading=math.pi / 2)
    assert straight == pytest.approx(np.column_stack([np.full(9, 10), 5 + s, np.full(9, math.pi / 2)]))
    arc = line('<arc curvature="0.1"/>', s)
    assert np.hypot(arc[:, 0] - 10, arc[:, 1] - 15) == pytest.approx(np.full(9, 10.0))
    assert arc[:, 2] == pytest.approx(0.1 * s)


@given(start=st.floats(-0.2, 0.2), end=st.floats(-0.2, 0.2), length=st.floats(1, 80))
@settings(max_examples=20, deadline=None)
def test_spirals_are_those_of_their_curvature(start, end, length) -> None:
    s = np.linspace(0, length, 2001)
    poses = line(f'<spiral curvStart="{start!r}" curvEnd="{end!r}"/>', s, length=length)
    turn = start * s + (end - start) / length * s**2 / 2
    assert poses[:, 2] == pytest.approx(turn)
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert steps == pytest.approx(np.full(2000, length / 2000), rel=1e-3)
    middle = np.arctan2(*np.diff(poses[:, :2], axis=0).T[::-1])
    assert np.cos(middle - (turn[1:] + turn[:-1]) / 2).min() > 1 - 1e-5


def test_polynomials() -> None:
    s = np.linspace(0, 20, 11)
    cubic = line('<poly3 a="0" b="0" c="0.05" d="-0.001"/>', s)
    u = cubic[:, 0] - 10
    assert cubic[:, 1] - 5 == pytest.approx(0.05 * u**2 - 0.001 * u**3)
    fine = np.linspace(0, u[-1], 20001)
    length = np.hypot(np.diff(fine), np.diff(0.05 * fine**2 - 0.001 * fine**3)).sum()
    assert length == pytest.approx(20, rel=1e-4)
    numbers = 'aU="0" bU="20" cU="0" dU="0" aV="0" bV="0" cV="6" dV="-4"'
    p = s / 20
    for shape in (f'<paramPoly3 {numbers} pRange="normalized"/>', f"<paramPoly3 {numbers}/>"):
        curve = line(shape, s)
        assert curve[:, :2] == pytest.approx(np.column_stack([10 + 20 * p, 5 + 6 * p**2 - 4 * p**3]))
    arc_length = 'aU="0" bU="1" cU="0" dU="0" aV="0" bV="0" cV="0.015" dV="-0.0005"'
    curve = line(f'<paramPoly3 {arc_length} pRange="arcLength"/>', s)
    assert curve[:, :2] == pytest.approx(np.column_stack([10 + s, 5 + 0.015 * s**2 - 0.0005 * s**3]))


def test_lanes_are_free_by_their_type() -> None:
    file = write(road("<line/>"))
    drive = import_map(file, "drive.yaml", resolution=0.1)
    assert drive.free_area == pytest.approx(60, rel=0.02)
    walk = import_map(file, "walk.yaml", resolution=0.1, lanes="walk")
    assert walk.free_area == pytest.approx(40, rel=0.02)
    assert walk.occupied > drive.unknown / 10
    both = import_map(file, "all.yaml", resolution=0.1, lanes="all")
    assert both.free_area == pytest.approx(100, rel=0.02)
    assert "lanes to drive" in drive.notes[0]
    assert read_sidecar("drive.yaml").to_scene([[3.0, 4.0]]).tolist() == [[3.0, 4.0, 0.0]]


def test_widths_offsets_and_sections() -> None:
    """A lane that grows from 2 m to 4 m, beside a line that is shifted by 1 m, ends where the next section begins."""
    lanes = """<lanes><laneOffset s="0" a="1" b="0" c="0" d="0"/><laneSection s="0"><right><lane id="-1" type="driving">
<width sOffset="0" a="2" b="0.2" c="0" d="0"/></lane></right></laneSection><laneSection s="10"><right>
<lane id="-1" type="shoulder"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right></laneSection></lanes>"""
    result = import_map(write(road("<line/>", lanes=lanes)), "x.yaml", resolution=0.05)
    assert result.free_area == pytest.approx(30, rel=0.02)
    assert result.trip is not None
    assert 5 + 1 - 4 < min(result.trip.start[1], result.trip.goal[1]) < 6


def test_a_bridge_over_a_road_is_another_level() -> None:
    high = '<elevationProfile><elevation s="0" a="6" b="0" c="0" d="0"/></elevationProfile>'
    crossing = road("<line/>", heading=math.pi / 2, more=high)
    below = import_map(write(road("<line/>"), crossing), "x.yaml", resolution=0.1)
    assert [round(one.height, 1) for one in below.levels] == [0.0, 6.0]


def entities() -> str:
    inside = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    return f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY e0 "ha">{inside}]>'


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "empty"),
        ("hello", "not a road network"),
        ("<?xml version='1.0'?><OpenDRIVE>", "damaged"),
        ("<?xml version='1.0'?><other/>", "an XML file of 'other'"),
        ("<OpenDRIVE></OpenDRIVE>", "no lanes"),
        (entities() + "<OpenDRIVE>&e11;</OpenDRIVE>", "entities"),
        ('<!DOCTYPE x SYSTEM "http://127.0.0.1:9/x"><OpenDRIVE/>', "entities"),
        ('<!DOCTYPE x [<!ENTITY f SYSTEM "file:///etc/passwd">]><OpenDRIVE>&f;</OpenDRIVE>', "entities"),
        ("<OpenDRIVE>" + "<a>" * 5000, "nested"),
        ("<?xml version='1.0' encoding='moon'?><OpenDRIVE/>", "damaged|decoded"),
        (f"<OpenDRIVE>{road('<line/>', length='nan')}</OpenDRIVE>", "length of <road> in road 7 is 'nan'"),
        (f"<OpenDRIVE>{road('<line/>', length='1e300')}</OpenDRIVE>", "must be a number"),
        (f"<OpenDRIVE>{road('<line/>', length='1e9')}</OpenDRIVE>", "geometry of"),
        (f"<OpenDRIVE>{road('<line/>', length='-3')}</OpenDRIVE>", "geometry of"),
        (f"<OpenDRIVE>{road('<loop/>')}</OpenDRIVE>", "other than arc"),
        (f"<OpenDRIVE>{road('<arc/>')}</OpenDRIVE>", "curvature of <arc> in road 7 is missing"),
    ],
)
def test_wrong_files_are_refused(content, said) -> None:
    file = Path("town.xodr")
    file.write_text(content)
    with pytest.raises(BridgeError, match=said) as caught:
        import_map(file, "x.yaml")
    assert caught.value.code == "bridge-file"
    assert [path.name for path in Path().iterdir()] == ["town.xodr"]


def test_a_file_that_ends_anywhere_is_refused() -> None:
    text = write(road('<arc curvature="0.1"/>')).read_bytes()
    for length in range(0, len(text) - 1, 7):
        Path("short.xodr").write_bytes(text[:length])
        with pytest.raises(BridgeError):
            import_map("short.xodr", "x.yaml")


def test_a_country_is_too_large() -> None:
    far = road("<line/>").replace('x="10"', 'x="900000"').replace('y="5"', 'y="70000"')
    with pytest.raises(BridgeError, match="--bounds"):  # the largest cells do not show a road
        import_map(write(road("<line/>"), far), "x.yaml")
    with pytest.raises(BridgeError, match="--resolution 100, a part of it"):
        import_map(write(road("<line/>"), far), "x.yaml", resolution=1)
