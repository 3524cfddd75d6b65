"""Record what RVO2 answers to random snapshots of agents among walls: writes ``orca.npz``.

Run it with an interpreter that has ``pyrvo`` (PyPI, 0.4.3), the solver that IR-SIM 2.12 calls::

    /tmp/reference/bin/python tests/parity/decisions/orca_record.py

Recording again gives the same file. Every number is single precision, which is what that solver computes in.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

SNAPSHOTS, AGENTS, CORNERS = 800, 8, 6
FILE = Path(__file__).with_name("orca.npz")


def scene(rng: np.random.Generator, index: int) -> dict[str, np.ndarray]:
    """One snapshot: the second half has walls, every eighth one is so crowded that agents overlap."""
    size = 2.0 if index % 8 == 0 else rng.uniform(3.0, 8.0)
    walls = _walls(rng, size) if index >= SNAPSHOTS // 2 else np.full((2, CORNERS, 2), np.nan)
    position = np.array([_free(rng, size, walls) for _ in range(AGENTS)])
    heading = rng.uniform(-np.pi, np.pi, AGENTS)
    top = rng.uniform(0.5, 2.0, AGENTS)
    speed = top * rng.uniform(0.0, 1.0, AGENTS)
    goal = position + rng.uniform(-8.0, 8.0, (AGENTS, 2))
    at_goal = rng.uniform(size=AGENTS) < 0.1
    goal[at_goal] = position[at_goal] + 0.02
    dt = rng.choice([0.05, 0.1, 0.25])
    options = [
        rng.uniform(2, 15),
        rng.integers(1, 11),
        rng.uniform(0.5, 12),
        rng.uniform(0.5, 6),
        rng.uniform(0, 0.2),
        dt,
    ]
    return {
        "position": position,
        "velocity": speed[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1),
        "goal": goal,
        "radius": rng.uniform(0.1, 0.4, AGENTS),
        "top": top,
        "options": np.array(options),  # neighborDist maxNeighbors timeHorizon timeHorizonObst safe_radius dt
        "walls": walls,
    }


def _walls(rng: np.random.Generator, size: float) -> np.ndarray:
    """Two outlines, counter-clockwise: a polygon with all corners on an ellipse, and another or a notched one."""
    walls = np.full((2, CORNERS, 2), np.nan)
    for k in range(2):
        centre = rng.uniform(-size / 2, size / 2, 2) + np.array([size * (k - 0.5), 0])
        turn = rng.uniform(-np.pi, np.pi)
        if rng.uniform() < 0.3:
            a, b = rng.uniform(0.8, 2.0, 2)
            shape = np.array([[0, 0], [a, 0], [a, 0.4], [0.4, 0.4], [0.4, b], [0, b]])
        else:
            count = int(rng.integers(3, CORNERS + 1))
            angles = np.sort(rng.uniform(-np.pi, np.pi, count))
            shape = np.stack([np.cos(angles), np.sin(angles)], axis=1) * rng.uniform(0.3, 1.5, 2)
            if np.min(np.linalg.norm(shape - np.roll(shape, 1, axis=0), axis=1)) < 0.1:
                shape = np.array([[-0.6, -0.2], [0.6, -0.2], [0.6, 0.2], [-0.6, 0.2]])
        c, s = np.cos(turn), np.sin(turn)
        walls[k, : len(shape)] = shape @ np.array([[c, s], [-s, c]]) + centre
    return walls


def _free(rng: np.random.Generator, size: float, walls: np.ndarray) -> np.ndarray:
    while True:
        p = rng.uniform(-size, size, 2)
        if all(not _inside(p, ring[~np.isnan(ring[:, 0])]) for ring in walls):
            return p


def _inside(p: np.ndarray, ring: np.ndarray) -> bool:
    inside = False
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if (a[1] > p[1]) != (b[1] > p[1]):
            inside ^= bool(p[0] < a[0] + (p[1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
    return inside


def answer(data: dict[str, np.ndarray]) -> np.ndarray | None:
    """(AGENTS, 2) new velocities; None if the solver cuts a wall in two (its search tree does, sometimes)."""
    import pyrvo

    reach, most, horizon, horizon_walls, margin, dt = (float(v) for v in data["options"])
    simulator = pyrvo.RVOSimulator()
    simulator.set_time_step(dt)
    corners = 0
    for ring in data["walls"]:
        ring = ring[~np.isnan(ring[:, 0])]
        corners += len(ring)
        if len(ring):
            simulator.add_obstacle([tuple(float(v) for v in p) for p in ring])
    simulator.process_obstacles()
    if simulator.get_num_obstacle_vertices() != corners:
        return None
    for k in range(AGENTS):
        radius = float(data["radius"][k]) + margin
        place, velocity = (tuple(float(v) for v in data[name][k]) for name in ("position", "velocity"))
        simulator.add_agent(place, reach, int(most), horizon, horizon_walls, radius, float(data["top"][k]), velocity)
        way = data["goal"][k].astype(float) - data["position"][k]
        distance = np.linalg.norm(way)
        preferred = way * (data["top"][k] / distance) if distance >= 0.1 else way * 0.0
        simulator.set_agent_pref_velocity(k, tuple(float(v) for v in preferred))
    simulator.do_step()
    velocities = [simulator.get_agent_velocity(k) for k in range(AGENTS)]
    return np.array([[v.x, v.y] for v in velocities])


def main() -> None:
    rng = np.random.default_rng(20110830)
    kept: dict[str, list[np.ndarray]] = {}
    for index in range(SNAPSHOTS):
        velocities = None
        while velocities is None:
            data = {name: value.astype(np.float32) for name, value in scene(rng, index).items()}
            velocities = answer(data)
        for name, value in {**data, "answer": velocities.astype(np.float32)}.items():
            kept.setdefault(name, []).append(value)
    np.savez_compressed(FILE, **{name: np.array(values) for name, values in kept.items()})
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
