"""One recorded episode, played again with the installed package: every bit of every pose and range must be the same.

``golden.py SCENE`` compares with ``golden.json`` and names the first step that differs; with ``--write`` it records
anew, which is right after a change of the core that changes results on purpose. The tests of wheels run it on each
platform, with the scene that ``irsim new crossing`` makes: three robots, people and a lidar.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import platform
import sys
from pathlib import Path

import irsim

KEPT = Path(__file__).with_name("golden.json")
SEED, STEPS, EVERY = 7, 150, 10


def play(scene: Path) -> list[str]:
    """Hashes of all poses and ranges so far, one for each ``EVERY`` steps."""
    env = irsim.make(scene, seed=SEED, headless=True, log_level="WARNING")
    seen, hashes = hashlib.sha256(), []
    for step in range(1, STEPS + 1):
        env.step()
        for thing in (*env.robot_list, *env.obstacle_list):
            seen.update(thing.state.tobytes())
        seen.update(env.get_lidar_scan()["ranges"].tobytes())
        if step % EVERY == 0:
            hashes.append(seen.hexdigest()[:16])
    env.end()
    return hashes


def main() -> int:
    """Compare or record; the exit status is 1 if anything differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=Path, help="the file that `irsim new crossing` has made")
    parser.add_argument("--write", action="store_true", help="record the episode instead of comparing it")
    given = parser.parse_args()
    hashes = play(given.scene)
    if given.write:
        KEPT.write_text(json.dumps(hashes, indent=1) + "\n", encoding="utf-8")
        return 0
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    where = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
    for index, (old, new) in enumerate(zip(kept, hashes, strict=True)):
        if old != new:
            first = index * EVERY + 1
            print(f"golden episode: steps {first} to {first + EVERY - 1} differ on {where}", file=sys.stderr)
            return 1
    print(f"golden episode: {STEPS} steps, {hashes[-1]}, on {where}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
