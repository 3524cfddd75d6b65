"""Gaussian splats against a known room, pycolmap, Chromium, and Spark, an independent renderer of splats."""

from __future__ import annotations

import functools
import http.server
import io
import json
import math
import os
import shutil
import threading
import urllib.parse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.bridges.frames import axes_of, camera_pose
from irsim.bridges.maps.importing import read_occupancy
from irsim.bridges.maps.sidecar import read_sidecar
from irsim.bridges.maps.source import ImportLimits, ImportOptions
from irsim.bridges.splats.page import write_page
from irsim.bridges.splats.reading import read_splats
from irsim.bridges.splats.render import View, picture
from tests.bridges.maps.scenes import flat
from tests.bridges.splats.conftest import Site
from tests.bridges.splats.scenes import FIELDS, room, write_ply
from tests.browser import NAMES, until

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("splats")]
SWITCHES = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
SPARK_PAGE = Path(__file__).with_name("spark_view.html")
WIDTH, ROWS, FOCAL = 400, 300, 250.0
EYE = (1.0, 1.0, 0.6)
"""x, y [m], yaw [rad] of the views that are compared."""
EYE_HEIGHT = 1.3


def test_pycolmap_reads_our_cameras_with_equal_centers_and_directions(site: Site, tmp_path: Path) -> None:
    pycolmap = pytest.importorskip("pycolmap")
    irsim.export_run(site.run, tmp_path / "model", to="colmap", options={"every": 3, "height": 1.1, "fov": 80.0})
    model = pycolmap.Reconstruction(str(tmp_path / "model"))
    poses = site.run.trace().pose[::3, site.run.index_of("rover")]
    assert model.num_images() == len(poses)
    sidecar = read_sidecar(site.scenario)
    turn = sidecar.T_scene_from_irsim[:3, :3]
    for image in model.images.values():
        x, y, yaw = poses[int(image.name.split(".")[0]) // 3]
        center = sidecar.to_scene(np.array([[x, y]]), height=1.1)[0]
        np.testing.assert_allclose(image.projection_center(), center, atol=1e-9)
        ahead = turn @ [math.cos(yaw), math.sin(yaw), 0]
        np.testing.assert_allclose(image.viewing_direction(), ahead, atol=1e-9)
        # A point three metres ahead and half a metre to the left is left of the middle of the picture.
        point = center + 3 * ahead + 0.5 * turn @ [-math.sin(yaw), math.cos(yaw), 0]
        u, v = image.project_point(point)
        focal = 640 / math.tan(math.radians(40))
        assert (u, v) == pytest.approx((640 - focal / 6, 360), abs=1e-6)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    program = os.environ.get("IRSIM_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip("needs Chromium")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=program, args=SWITCHES)
        yield started
        started.close()


def ready(page: Any) -> None:
    until(page, "document.getElementById('view').dataset.state === 'ready'", 60)


def shot(page: Any) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(float)


@pytest.fixture
def page(site: Site, browser: Any, tmp_path: Path) -> Iterator[Any]:
    """The page of the run, offline; it writes nothing to the console and asks for nothing but itself."""
    write_page(site.scene, site.run, tmp_path / "room.html")
    context = browser.new_context(viewport={"width": 800, "height": 560}, offline=True)
    opened, problems, requests = context.new_page(), list[str](), list[str]()
    opened.on("console", lambda message: problems.append(message.text))
    opened.on("pageerror", lambda error: problems.append(str(error)))
    opened.on("request", lambda request: requests.append(request.url))
    opened.goto((tmp_path / "room.html").as_uri())
    ready(opened)
    yield opened
    context.close()
    assert problems == []
    assert [address for address in requests if not address.startswith(("file:", "blob:"))] == []


def blue(pixels: np.ndarray) -> np.ndarray:
    """Pixels of the robot and its path."""
    return (pixels[..., 2] > 110) & (pixels[..., 0] < 60) & (pixels[..., 1] < 60)


def brown(pixels: np.ndarray) -> np.ndarray:
    """Pixels of the table, which only splats show."""
    return (pixels[..., 0] > 1.2 * pixels[..., 1]) & (pixels[..., 1] > 1.2 * pixels[..., 2]) & (pixels[..., 0] > 90)


def test_the_page_shows_splats_path_and_robot(page: Any) -> None:
    first = shot(page)
    assert blue(first).sum() > 60
    assert brown(first).sum() > 300
    page.locator("#time").evaluate("time => { time.value = time.max; time.dispatchEvent(new Event('input')) }")
    ready(page)
    page.wait_for_timeout(300)
    last = shot(page)
    middles = [
        np.argwhere(blue(pixels) & ~blue(other)).mean(axis=0) for pixels, other in ((first, last), (last, first))
    ]
    assert middles[1][1] - middles[0][1] > 60  # the robot went to the right
    page.locator("#shown").uncheck()
    page.wait_for_timeout(300)
    assert brown(shot(page)).sum() < 30
    assert blue(shot(page)).sum() > 60
    page.locator("#shown").check()
    page.select_option("#eye", "behind")
    ready(page)
    page.wait_for_timeout(300)
    behind = blue(shot(page))
    assert behind[280:500, 270:530].sum() > 500  # large, below the middle


def test_the_page_plays(page: Any) -> None:
    page.click("#play")
    until(page, "Number(document.getElementById('time').value) > 3", 30)
    page.click("#play")
    assert page.inner_text("#clock").endswith(" s")


def ratio(one: np.ndarray, other: np.ndarray) -> float:
    """Peak signal-to-noise ratio [dB]."""
    return float(10 * np.log10(255**2 / np.mean((one - other) ** 2)))


def our_picture(scene: Path, matrix: np.ndarray) -> np.ndarray:
    view = View(matrix, WIDTH, ROWS, FOCAL)
    return picture(read_splats(scene, harmonics=True), view).astype(float)


def test_the_page_and_the_picture_of_the_cpu_agree(site: Site, page: Any) -> None:
    page.set_viewport_size({"width": WIDTH, "height": ROWS})
    place = camera_pose(np.array(EYE), "opengl", EYE_HEIGHT)
    look = "([eye, target, focal]) => irsim.look(eye, target, focal, [1, 1, 1], false)"
    page.evaluate(look, [place[:3, 3].tolist(), (place[:3, 3] - place[:3, 2]).tolist(), FOCAL])
    page.wait_for_timeout(300)
    ready(page)
    page.evaluate("() => document.querySelectorAll('header, footer').forEach(part => part.style.display = 'none')")
    page.wait_for_timeout(500)
    matrix = camera_pose(np.array(EYE), "colmap", EYE_HEIGHT, transform=read_sidecar(site.scenario).T_scene_from_irsim)
    decibels = ratio(shot(page), our_picture(site.scene, matrix))
    print(f"page against CPU: {decibels:.1f} dB")
    assert decibels > 40


@pytest.fixture(scope="module")
def spark_files() -> Path:
    """The folder node_modules with Spark and three.js."""
    folder = os.environ.get("IRSIM_SPARK")
    if folder is None:
        pytest.skip("needs @sparkjsdev/spark from npm, in the folder that IRSIM_SPARK names")
    return Path(folder)


class Files(http.server.SimpleHTTPRequestHandler):
    """Serves the page, a scene, and what npm has installed; the browser opens no modules from files."""

    def __init__(self, *arguments: Any, folder: Path, scene: Path, **options: Any) -> None:
        self.folder, self.scene = folder, scene
        super().__init__(*arguments, **options)

    def translate_path(self, path: str) -> str:
        name = path.partition("?")[0]
        return str({"/": SPARK_PAGE, "/scene.ply": self.scene}.get(name, self.folder / name.lstrip("/")))

    def log_message(self, *arguments: Any) -> None:
        pass


def spark_picture(browser: Any, folder: Path, scene: Path, matrix: np.ndarray) -> np.ndarray:
    """The picture that Spark draws; the matrix describes an OpenGL camera in the frame of the scene."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, folder=folder, scene=scene))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        opened = browser.new_page(viewport={"width": WIDTH, "height": ROWS})
        ask = {
            "width": WIDTH, "height": ROWS, "fov": math.degrees(2 * math.atan(ROWS / 2 / FOCAL)),
            "matrix": json.dumps(matrix.T.ravel().tolist()), "scene": "/scene.ply",
        }  # fmt: skip
        opened.goto(f"http://127.0.0.1:{server.server_port}/?{urllib.parse.urlencode(ask)}")
        until(opened, "document.body.dataset.state === 'ready'", 90)
        pixels = shot(opened)
        opened.close()
        return pixels
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


@pytest.mark.parametrize("harmonics", [False, True])
def test_the_picture_of_the_cpu_is_that_of_spark(site: Site, browser: Any, spark_files: Path, harmonics: bool) -> None:
    columns, fields = room(spacing=0.09, axes=axes_of("colmap"), shift=(0.0, 1.2, 0.0)).columns, FIELDS
    if harmonics:  # colors that change with the direction of view, alike for all splats: Spark stores them coarsely
        rest = np.tile(np.random.default_rng(5).normal(0, 0.1, 45), (len(columns), 1))
        columns, fields = np.column_stack([columns, rest]), (*FIELDS, *(f"f_rest_{number}" for number in range(45)))
    scene = write_ply(Path("seen.ply"), columns, fields=fields)
    pose, transform = np.array(EYE), read_sidecar(site.scenario).T_scene_from_irsim
    theirs = spark_picture(browser, spark_files, scene, camera_pose(pose, "opengl", EYE_HEIGHT, transform=transform))
    ours = our_picture(scene, camera_pose(pose, "colmap", EYE_HEIGHT, transform=transform))
    decibels = ratio(ours, theirs)
    print(f"CPU against Spark, harmonics {harmonics}: {decibels:.1f} dB")
    assert decibels > 36
    wrong = camera_pose(pose + np.array([0, 0, 0.03]), "colmap", EYE_HEIGHT, transform=transform)
    assert ratio(our_picture(scene, wrong), theirs) < decibels - 5  # the measure sees two degrees


def test_a_mesh_with_y_down_gives_the_map_of_the_same_mesh_with_z_up(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    values = []
    for up, frame in (("z", "irsim"), ("y", "habitat_yup"), ("-y", "colmap")):
        corners = flat().reshape(-1, 3) @ axes_of(frame).T
        mesh = trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)
        mesh.export(tmp_path / "flat.ply")
        _, plan, source = read_occupancy(tmp_path / "flat.ply", ImportOptions(up=up, resolution=0.1), ImportLimits())
        assert (source["kind"], plan.frame) == ("mesh", frame)
        values.append(plan.values)
    assert (values[0] == 0).sum() > 1000
    for other in values[1:]:
        assert other.shape == values[0].shape
        assert (other != values[0]).mean() < 0.01  # cells whose border a wall lies on
