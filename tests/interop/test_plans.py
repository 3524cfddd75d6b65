"""Floor plans in DXF as ezdxf writes them: the occupied area equals the area of the drawing."""

from __future__ import annotations

import math

import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map

pytestmark = pytest.mark.interop
ezdxf = pytest.importorskip("ezdxf")


def occupied(folder, document) -> float:
    document.saveas(folder / "a.dxf")
    result = import_map(folder / "a.dxf", folder / "a.yaml")
    return result.occupied * result.resolution**2


def test_a_plan_in_millimeters(tmp_path) -> None:
    document = ezdxf.new("R2010", setup=True)
    document.units = ezdxf.units.MM
    space = document.modelspace()
    for margin in (0, 300):  # the two faces of a wall
        far_x, far_y = 10_000 - margin, 8_000 - margin
        corners = [(margin, margin), (far_x, margin), (far_x, far_y), (margin, far_y)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "0"})
    space.add_line((4_000, 300), (4_000, 5_000))
    space.add_lwpolyline([(300, 6_000), (3_000, 6_000)], dxfattribs={"const_width": 400})
    column = document.blocks.new("column")
    column.add_circle((0, 0), 500, dxfattribs={"layer": "columns"})
    space.add_blockref("column", (7_000, 3_000))
    space.add_blockref("column", (7_000, 6_000))
    hatch = space.add_hatch()
    hatch.paths.add_polyline_path([(1_000, 1_000), (2_000, 1_000), (2_000, 3_000), (1_000, 3_000)], is_closed=True)
    space.add_text("Hall")
    area = 10 * 8 - 9.4 * 7.4 + 0.2 * 4.7 + 2.7 * 0.4 + 2 * math.pi * 0.25 + 2
    assert occupied(tmp_path, document) == pytest.approx(area, rel=0.01)


def test_a_large_plan_gets_cells_that_fit(tmp_path) -> None:
    document = ezdxf.new()
    document.modelspace().add_lwpolyline([(0, 0), (300, 0), (300, 200), (0, 200)], close=True)
    document.saveas(tmp_path / "a.dxf")
    result = import_map(tmp_path / "a.dxf", tmp_path / "a.yaml")
    assert result.resolution == 0.1
    assert any("cells are 0.1 m" in note for note in result.notes)


@pytest.mark.parametrize("share", [0.3, 0.7])
def test_truncated_plans_are_refused(tmp_path, share) -> None:
    document = ezdxf.new()
    document.modelspace().add_line((0, 0), (5, 0))
    document.saveas(tmp_path / "a.dxf")
    content = (tmp_path / "a.dxf").read_bytes()
    (tmp_path / "a.dxf").write_bytes(content[: int(share * len(content))])
    with pytest.raises(BridgeError):
        import_map(tmp_path / "a.dxf", tmp_path / "a.yaml")
