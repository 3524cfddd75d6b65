"""Questions as people write them, and the pages of which one must be among the first three that the search finds."""

QUESTIONS = {
    "How do I add noise to a lidar?": ("reference/sensor/lidar2d", "reference/sensor/fmcw_lidar2d"),
    "what does the code unknown-key mean": ("reference/codes",),
    "install the skills for claude": ("reference/commands/skills-install", "start/agents", "README"),
    "connect to ROS 2": ("skills/irsim-runner/bridges/ros2", "reference/bridge/ros2"),
    "orca time horizon": ("reference/behavior/orca",),
    "how do I train a policy": ("reference/commands/train", "skills/irsim-runner/guides/learning", "start/learning"),
    "pedestrians recorded from ETH": (
        "skills/irsim-runner/bridges/pedestrians", "reference/commands/bridge-import-pedestrians",
    ),
    "export a run to csv": ("reference/commands/export", "skills/irsim-runner/references/exports"),
    "differences from IR-SIM 2.12": ("start/from-ir-sim", "irsim/compat/README"),
    "what is success weighted by path length spl": ("reference/metrics", "skills/irsim-benchmark/references/metrics"),
    "wheelchair": ("reference/things",),
    "Ackermann steering car": ("reference/kinematics/acker", "gallery/car-park"),
    "narrow corridor with two robots": ("gallery/corridor-passing",),
    "warehouse": ("gallery/warehouse",),
    "run a benchmark on a cluster with ray": (
        "skills/irsim-benchmark/references/cluster", "reference/commands/benchmark",
    ),
    "map from a floor plan": ("reference/commands/map-import", "skills/irsim-runner/bridges/maps"),
    "A* planner": ("reference/planner/astar", "reference/planner/index", "reference/behavior/follow"),
    "validate_scenario tool arguments": ("reference/tools",),
    "write a case for evaluating agents": ("evals/write-a-case", "evals/README"),
    "is the audit independent of the engine": (
        "skills/irsim-benchmark/guides/audit", "reference/commands/audit", "skills/irsim-benchmark/results/referee",
    ),
}  # fmt: skip
