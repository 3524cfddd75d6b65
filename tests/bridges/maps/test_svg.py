"""Plans in SVG, without the library that reads shapes: what of a tree draws, and which areas closed lines fill."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.areas import filled, nested
from irsim.bridges.maps.kinds._svg_areas import Clips
from irsim.bridges.maps.kinds._svg_clips import CLIP, CLIPPED, UNREAD
from irsim.bridges.maps.kinds._svg_tree import cleaned

PLAN = """<svg><style>.a {fill: red}</style><metadata/>
  <g label="walls"><path id="w"/><text>Hall</text></g>
  <g id="stuff"><g><rect id="r"/></g><image href="http://a.invalid/b.png"/></g>
  <a><circle id="c"/></a><g style="fill: red; display : none"><rect/></g>
  <script/><defs><rect id="d"/></defs><use href="#d"/></svg>"""


def shapes(layers=None) -> tuple[list[str], list[str]]:
    tree = cleaned(Path("a.svg"), ET.fromstring(PLAN), layers)
    return [item.tag + item.get("id", "") for item in tree.root.iter() if item.tag not in ("svg", "g")], tree.notes


def test_only_what_draws_is_left() -> None:
    tags, notes = shapes()
    assert tags == ["style", "pathw", "rectr", "circlec", "defs", "rectd", "use"]
    assert notes == ["left out: 1 text, 1 picture, 1 hidden"]


def test_layers_are_chosen_by_label_or_id() -> None:
    assert shapes(["stuff"])[0] == ["style", "rectr", "defs", "rectd"]
    assert shapes(["walls", "stuff"])[0] == ["style", "pathw", "rectr", "defs", "rectd"]
    with pytest.raises(BridgeError, match="no layer 'Walls'"):
        shapes(["Walls"])


def test_clip_paths_stand_before_what_they_cut_off() -> None:
    text = """<svg><clipPath id="c"><rect id="x"/></clipPath><rect id="a" clip-path="url(#c)" transform="scale(2)"/>
      <g style="clip-path: url('#c')"><path/></g><path clip-path="url(#none)" data-irsim-clip="3"/>
      <path mask="url(#m)"/></svg>"""
    root = cleaned(Path("a.svg"), ET.fromstring(text), None).root
    wrapped, group, path, masked = list(root)
    [[shapes], rect] = wrapped
    assert (wrapped.get("id"), rect.get("label"), wrapped[0].get("transform")) == ("a", "a", "scale(2)")
    assert shapes.get(CLIP) == "1"
    assert wrapped.get(f"{CLIPPED}1")
    assert group.get(CLIPPED + group[0].get(CLIP, "none"))
    assert (path.attrib, masked.get(UNREAD)) == ({"clip-path": "url(#none)"}, "mask")
    many = "<g>" + '<path clip-path="url(#c)"/>' * 1000 + "</g>"
    text = '<svg><clipPath id="c">' + "<rect/>" * 300 + f"</clipPath>{many}</svg>"
    with pytest.raises(BridgeError, match="more than 200,000 shapes"):
        cleaned(Path("a.svg"), ET.fromstring(text), None)


def test_a_clip_path_is_used_where_it_was_drawn_last() -> None:
    clips, whole = Clips(), shapely.box(0, 0, 9, 9)
    clips.add("1", shapely.box(0, 0, 1, 1))
    clips.add("1", shapely.box(4, 0, 5, 2))
    assert clips.cut(["1"], whole).area == clips.cut(["1"], whole).area == 3
    clips.add("1", shapely.box(0, 0, 2, 2))
    assert clips.cut(["1"], whole).area == 4
    assert clips.cut(["1", "2"], whole).is_empty


def square(x: float, y: float, side: float, *, turned: bool = False) -> np.ndarray:
    corners = np.array([(x, y), (x + side, y), (x + side, y + side), (x, y + side)])
    return corners[::-1] if turned else corners


def test_lines_that_go_around_in_one_direction_fill_what_both_directions_leave_open() -> None:
    assert filled([square(0, 0, 4)]).area == 16
    assert filled([square(0, 0, 4), square(1, 1, 2)]).area == 16
    assert filled([square(0, 0, 4), square(1, 1, 2, turned=True)]).area == 12
    assert filled([square(0, 0, 4), square(3, 0, 4)]).area == 28
    bow = np.array([(0, 0), (2, 2), (2, 0), (0, 2)])
    assert filled([bow]).area == 2
    assert filled([np.array([(0, 0), (1, 0), (2, 0)])]).is_empty
    star = [(np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5)) for k in range(5)]
    assert filled([np.array(star)]).area > nested([filled([np.array(star)]), filled([square(-0.1, -0.1, 0.2)])]).area
