"""Draws the picture of the page about maps: ``python -m tests.bridges.maps.draw`` (needs trimesh)."""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from PIL import Image

import irsim
from irsim.bridges.maps import import_map
from irsim.scenario.read import read
from tests.bridges.maps.flat import flat, storey, write_glb

PAGE = Path(__file__).resolve().parents[3] / "skills" / "irsim-runner" / "bridges" / "maps.png"
CUT = 1.0
"""Height above which nothing is drawn [m]."""


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        import_map(write_glb(folder / "flat.glb", flat()), folder / "flat.yaml", robot=True)
        grid = read(folder / "flat.yaml").scenario.grid
        env = irsim.make(str(folder / "flat.yaml"), display=False, seed=0)
        way = [env.robot.state[:2, 0]]
        while not env.done():
            env.step()
            way.append(env.robot.state[:2, 0])
        env.end()
    figure = plt.figure(figsize=(8, 2.9), dpi=90)
    left = figure.add_axes((-0.01, -0.16, 0.52, 1.32), projection="3d")
    triangles = storey()
    triangles = triangles[triangles[..., 2].min(axis=1) < CUT]
    triangles = np.minimum(triangles, [np.inf, np.inf, CUT])  # walls are drawn low, to look over them
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    light = normals @ [0.3, -0.5, 0.8] / (np.linalg.norm(normals, axis=1) + 1e-9)
    grey = np.clip(0.55 + 0.4 * light, 0.15, 1)
    left.add_collection3d(Poly3DCollection(triangles, facecolors=np.column_stack([grey, grey, 0.95 * grey])))
    left.set(xlim=(0, 8), ylim=(-1, 7), zlim=(0, 4), box_aspect=(8, 8, 4))
    left.view_init(50, -62)
    left.set_axis_off()
    right = figure.add_axes((0.52, 0.06, 0.46, 0.9))
    (x, y), (nx, ny) = grid.origin, grid.size
    extent = (x, x + nx * 0.05, y, y + ny * 0.05)
    right.imshow(1 - np.asarray(grid.cells.occupied, float).T, origin="lower", extent=extent, cmap="gray")
    right.plot(*np.array(way).T, color="#D55E00", lw=2)
    right.plot(*way[0], "o", color="#0072B2")
    right.plot(*way[-1], "*", color="#009E73", ms=11)
    right.tick_params(labelsize=7)
    figure.savefig(PAGE)
    image = Image.open(PAGE).convert("RGB")
    image.quantize(32).save(PAGE, optimize=True)


if __name__ == "__main__":
    main()
