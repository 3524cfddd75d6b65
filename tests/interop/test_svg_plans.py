"""Floor plans in SVG as other programs write them: the occupied area is the area that they draw."""

from __future__ import annotations

import math

import matplotlib
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch, Polygon, Rectangle
from matplotlib.path import Path as Curve

from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map
from irsim.bridges.maps.source import ImportLimits
from irsim.diagnostics.errors import ArgumentError

pytestmark = pytest.mark.interop
drawsvg = pytest.importorskip("drawsvg")
ezdxf = pytest.importorskip("ezdxf")
drawing = pytest.importorskip("ezdxf.addons.drawing")
svgwrite = pytest.importorskip("svgwrite")
pytest.importorskip("svgelements")


def area(file, **options) -> float:
    result = import_map(file, file.with_suffix(".yaml"), overwrite=True, **options)
    return result.occupied * result.resolution**2


def test_a_plan_of_svgwrite_in_millimeters_with_layers(tmp_path) -> None:
    plan = svgwrite.Drawing(str(tmp_path / "a.svg"), size=("10000mm", "8000mm"), viewBox="0 0 10000 8000")
    plan.add(plan.rect((0, 0), (10_000, 8_000), fill="white"))
    walls = plan.add(plan.g(id="walls", fill="none", stroke="black", stroke_width=200))
    walls.add(plan.rect((100, 100), (9_800, 7_800)))
    walls.add(plan.line((4_000, 200), (4_000, 5_000)))
    walls.add(plan.rect((3_800, 1_000), (400, 900), fill="white", stroke="none"))  # a door
    column = plan.defs.add(plan.circle((0, 0), 300, id="column"))
    stuff = plan.add(plan.g(id="stuff", transform="translate(7000 3000) rotate(30)"))
    stuff.add(plan.use(column))
    stuff.add(plan.use(column, insert=(0, 2_000)))
    stuff.add(plan.rect((500, 500), (800, 600), rx=100))
    plan.add(plan.text("Hall", (500, 500)))
    plan.save()
    of_walls = 10 * 8 - 9.6 * 7.6 + 0.2 * (4.8 - 0.9)
    of_stuff = 2 * math.pi * 0.09 + 0.48 - (4 - math.pi) * 0.01
    assert area(tmp_path / "a.svg", layers=("walls",)) == pytest.approx(of_walls, rel=0.01)
    assert area(tmp_path / "a.svg") == pytest.approx(of_walls + of_stuff, rel=0.01)
    with pytest.raises(BridgeError, match="no layer 'Walls'") as caught:
        area(tmp_path / "a.svg", layers=("Walls",))
    assert "stuff, walls" in str(caught.value.fix)


def test_a_figure_of_matplotlib_on_a_scale(tmp_path) -> None:
    figure = Figure(figsize=(10, 8))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, 20), ylim=(0, 16))
    axes.axis("off")
    axes.add_patch(Rectangle((2, 2), 5, 3, angle=20, color="black", linewidth=0))
    axes.add_patch(Circle((13, 5), 1.5, color="tab:red", linewidth=0))
    axes.add_patch(Polygon([(3, 10), (8, 10), (5, 14)], color="#555555", linewidth=0))
    ring = Curve.make_compound_path(Curve.circle((14, 11), 2), Curve(Curve.circle((14, 11), 1).vertices[::-1],
                                                                     Curve.circle((14, 11), 1).codes))  # fmt: skip
    axes.add_patch(PathPatch(ring, color="navy", linewidth=0))
    axes.plot([1, 19], [15, 15], color="black", linewidth=7.2, solid_capstyle="butt")  # 0.2 m
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        figure.savefig(tmp_path / "a.svg")
    expected = 15 + math.pi * 2.25 + 10 + math.pi * 3 + 18 * 0.2
    assert area(tmp_path / "a.svg", meters_per_unit=20 / 720) == pytest.approx(expected, rel=0.01)  # points of 1/72 in
    note = import_map(tmp_path / "a.svg", tmp_path / "b.yaml").notes
    assert any("on paper" in line and "--meters-per-unit 0.03528" in line for line in note), note


def test_a_drawing_of_drawsvg_with_curves_strokes_and_holes(tmp_path) -> None:
    plan = drawsvg.Drawing(1_200, 900, origin="center")
    plan.append(drawsvg.Circle(-300, 0, 100, fill="#222"))
    plan.append(drawsvg.Ellipse(0, -200, 150, 60, fill="black", transform="rotate(25)"))
    plan.append(drawsvg.Path("M 200,-100 h 200 v 200 h -200 z M 250,-50 h 100 v 100 h -100 z",
                             fill="black", fill_rule="evenodd"))  # fmt: skip
    plan.append(drawsvg.Lines(-500, 300, -100, 300, -100, 400, fill="none", stroke="black", stroke_width=20))
    plan.append(drawsvg.Arc(300, 300, 100, 0, 90, fill="none", stroke="brown", stroke_width=10))
    plan.append(drawsvg.Image(-500, -400, 100, 100, path="http://example.invalid/a.png"))
    plan.save_svg(str(tmp_path / "a.svg"))
    corner = 0.2 * 0.2 / 4
    strokes = 0.2 * 4 + 0.2 * 1 + corner + 3 * math.pi / 2 * 0.1
    expected = math.pi + math.pi * 1.5 * 0.6 + 3 + strokes
    assert area(tmp_path / "a.svg", meters_per_unit=0.01) == pytest.approx(expected, rel=0.01)


def test_a_plan_that_ezdxf_draws_as_svg(tmp_path) -> None:
    from ezdxf.addons.drawing import layout, svg

    document = ezdxf.new("R2010")
    space = document.modelspace()
    hatch = space.add_hatch(color=7)
    hatch.paths.add_polyline_path([(0, 0), (6, 0), (6, 1), (1, 1), (1, 4), (0, 4)], is_closed=True)
    disk = space.add_hatch(color=7)
    disk.paths.add_edge_path().add_arc((4, 3), 0.8, 0, 360)
    backend = svg.SVGBackend()
    config = drawing.config.Configuration(background_policy=drawing.config.BackgroundPolicy.WHITE)
    drawing.Frontend(drawing.RenderContext(document), backend, config=config).draw_layout(space)
    page = layout.Page(600, 400, layout.Units.mm, layout.Margins.all(0))
    (tmp_path / "a.svg").write_text(backend.get_string(page, settings=layout.Settings(fit_page=True)))
    unit = 6 / 1_000_000  # the longer side of its view box
    assert area(tmp_path / "a.svg", meters_per_unit=unit) == pytest.approx(9 + math.pi * 0.64, rel=0.01)


def test_clip_paths_cut_off_what_one_does_not_see(tmp_path) -> None:
    """Of shapes, groups and uses, each where it is placed; a clip path without shapes leaves nothing."""
    plan = svgwrite.Drawing(str(tmp_path / "a.svg"), size=("20mm", "20mm"), viewBox="0 0 20 20")
    left = plan.defs.add(plan.clipPath(id="left"))
    left.add(plan.rect((0, 0), (2, 9)))
    ring = plan.defs.add(plan.clipPath(id="ring", transform="translate(1 0)"))
    ring.add(plan.path("M0 0 h4 v4 h-4 z M1 1 h2 v2 h-2 z", clip_rule="evenodd"))
    plan.defs.add(plan.clipPath(id="nothing"))
    plan.add(plan.rect((1, 1), (3, 1), clip_path="url(#left)"))  # 1 x 1
    group = plan.add(plan.g(clip_path="url(#ring)", transform="translate(10 0)"))
    group.add(plan.rect((0, 0), (9, 9)))  # 12
    group.add(plan.rect((0, 0), (9, 1), clip_path="url('#left')", fill="none", stroke="black"))  # within the ring
    part = plan.defs.add(plan.g(id="part"))
    part.add(plan.rect((0, 0), (4, 1), style="clip-path: url(#left); fill: #333"))  # 2 each time
    plan.add(plan.use(part, insert=(0, 10)))
    plan.add(plan.use(part, insert=(10, 10), transform="scale(1 1.5)"))
    cut = plan.add(plan.g(clip_path="url(#left)", transform="translate(0 14)"))
    cut.add(plan.use(part, insert=(1, 0)))  # 1
    plan.add(plan.rect((5, 5), (3, 3), clip_path="url(#nothing)"))
    plan.add(plan.rect((5, 16), (2, 2), clip_path="url(#missing)"))  # 4, as in browsers
    plan.save()
    result = import_map(tmp_path / "a.svg", tmp_path / "a.yaml", meters_per_unit=1.0)
    assert result.occupied * result.resolution**2 == pytest.approx(1 + 12 + 2 + 3 + 1 + 4, rel=0.01)
    assert not result.notes


def test_masks_and_clip_paths_in_other_units_are_said_with_their_share(tmp_path) -> None:
    whole = '<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width="1" height="0.5"/></clipPath>'
    shapes = '<rect width="2" height="1" clip-path="url(#c)"/><g mask="url(#m)"><rect y="4" width="1" height="1"/></g>'
    (tmp_path / "a.svg").write_text(HEAD + whole + shapes + '<rect x="5" y="5" width="1" height="1"/></svg>')
    notes = import_map(tmp_path / "a.svg", tmp_path / "a.yaml", meters_per_unit=1.0).notes
    assert "what masks and clip paths in other units cut off is part of the map: 2 areas, 75.0% of what" in notes[0]


def test_plans_that_cross_too_often_are_refused_by_the_process_that_reads_them(tmp_path) -> None:
    """Their areas would fill the memory of the caller."""
    lines = "".join(f'<path d="M0 {k / 300} L9 {k / 300} M{k / 300} 0 v9"/>' for k in range(1, 1500))
    (tmp_path / "a.svg").write_text(HEAD + f'<g fill="none" stroke="black" stroke-width="0.0001">{lines}</g></svg>')
    with pytest.raises(BridgeError, match=r"its areas cross so often|longer than 5 s"):
        import_map(tmp_path / "a.svg", tmp_path / "a.yaml", meters_per_unit=1.0, limits=ImportLimits(seconds=5))


HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 9">'


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (HEAD, "damaged"),
        (HEAD + "</svg>", "darker than white"),
        (HEAD + '<use xlink:href="other.svg#a"/></svg>', "'other.svg#a', and nothing outside"),
        (HEAD + '<use xlink:href="https://a.invalid/b#a"/></svg>', "nothing outside"),
        (HEAD + '<g id="a"><use xlink:href="#a"/></g></svg>', "'a' uses itself"),
        ('<!DOCTYPE svg [<!ENTITY a "b">]>' + HEAD + "</svg>", "entities"),
        (HEAD + '<path d="M0 0 L 1e400 3 L 4 4 z"/></svg>', "not finite"),
        (HEAD + '<path d="' + "M0 0 a900 900 0 0 0 999 999 z" * 15_000 + '"/></svg>', "more than 2,000,000 points"),
        (HEAD + "".join(f'<g id="a{k}">' + f'<use href="#a{k - 1}"/>' * 10 + "</g>" for k in range(9)) + "</svg>",
         "more than 200,000 shapes"),
        (HEAD.replace("0 0 9 9", "0 0 0 9") + "<path d='M0 0 L1 1 L0 1z'/></svg>", "cannot be imported"),
        ("<svg><rect width='a' height='3'/></svg>", "cannot be imported"),
    ],
)  # fmt: skip
def test_wrong_drawings_are_refused(tmp_path, content, message) -> None:
    (tmp_path / "a.svg").write_text(content)
    with pytest.raises(BridgeError, match=message):
        import_map(tmp_path / "a.svg", tmp_path / "a.yaml", meters_per_unit=1.0)
    assert not (tmp_path / "a.yaml").exists()


def test_y_points_up_and_files_without_layers_refuse_them(tmp_path) -> None:
    (tmp_path / "a.svg").write_text(HEAD + '<rect x="1" y="1" width="2" height="1"/></svg>')
    result = import_map(tmp_path / "a.svg", tmp_path / "a.yaml", meters_per_unit=1.0)
    left, lower = result.origin
    assert (left, lower) == pytest.approx((1 - 0.55, 7 - 0.55))
    (tmp_path / "a.geojson").write_text('{"type": "FeatureCollection", "features": []}')
    with pytest.raises(ArgumentError, match="the option layers says nothing"):
        import_map(tmp_path / "a.geojson", tmp_path / "b.yaml", layers=("a",))
