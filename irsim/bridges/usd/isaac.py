"""Isaac Sim follows irsim over ROS 2: paste this file into its Script Editor (Window, Script Editor), then press Run.

Copy ``follow.py``, which is beside this file, into a folder and write that folder below. Enable the extension
``isaacsim.ros2.bridge`` first: it brings ``rclpy``. Open the stage that ``irsim export --to usd`` wrote, or name the
prims of your own stage in ``PRIMS``. Run the script again to stop.
"""

from __future__ import annotations

import sys
from typing import Any

FOLDER = "/path/of/the/folder/with/follow.py"
PRIMS: dict[str, str] | None = None
"""Name of an object -> path of its prim, such as {"walker": "/World/Characters/Bob"}; None for an exported stage."""
WORLD_FRAME: str | None = None
"""Take only transforms from this frame, such as "map"."""
PEDESTRIANS: list[str] | None = None
"""Names of the poses of the topic /pedestrians, in order; None: pedestrians come with /tf, as all others do."""


def start(stage: Any, updates: Any) -> Any:
    """Subscribe, and follow in every update of the program.

    Args:
        stage: The stage.
        updates: Calls a function in every update of the program, as :func:`every_update` does.

    Returns:
        A function that ends it.
    """
    import rclpy
    from follow import Follower  # type: ignore[import-not-found]
    from geometry_msgs.msg import PoseArray  # type: ignore[import-not-found]
    from tf2_msgs.msg import TFMessage  # type: ignore[import-not-found]

    follower = Follower(stage, PRIMS)
    if not rclpy.ok():
        rclpy.init()
    node = rclpy.create_node("isaac_follows_irsim")
    node.create_subscription(TFMessage, "/tf", lambda message: follower.transforms(message, WORLD_FRAME), 100)
    if PEDESTRIANS is not None:
        names = PEDESTRIANS
        node.create_subscription(PoseArray, "/pedestrians", lambda message: follower.pose_array(message, names), 10)

    def update() -> None:
        for _ in range(20):  # what has come since the last picture
            rclpy.spin_once(node, timeout_sec=0.0)

    subscription = updates(update)

    def stop() -> None:
        nonlocal subscription
        subscription = None
        follower.release()
        node.destroy_node()

    return stop


def every_update(call: Any) -> Any:
    """Call a function in every update of Isaac Sim, as long as what this returns is kept."""
    import omni.kit.app

    stream = omni.kit.app.get_app().get_update_event_stream()
    return stream.create_subscription_to_pop(lambda event: call(), name="isaac_follows_irsim")


def main() -> None:
    """Start, or stop what an earlier run of the script has started."""
    import builtins

    import omni.usd

    running: Any = builtins.__dict__.pop("irsim_stop", None)
    if running is not None:
        running()
        print("irsim: stopped")
        return
    sys.path.insert(0, FOLDER)
    builtins.__dict__["irsim_stop"] = start(omni.usd.get_context().get_stage(), every_update)
    print("irsim: following /tf; run the script again to stop")


if not __name__.startswith("irsim."):  # the name that the editor gives it is not known
    main()
