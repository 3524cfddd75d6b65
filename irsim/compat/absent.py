"""Names of IR-SIM 2.12 that irsim lacks, and why."""

from __future__ import annotations

__all__ = ["ABSENT"]

_SEARCH = "the core searches: `planning` returns the path, `node_list` holds the visited nodes"
_SEARCH_STEPS = {
    "AStarPlanner": "Node calc_final_path calc_grid_index calc_grid_position calc_heuristic calc_xy_index check_node "
    "get_motion_model verify_node",
    "JPSPlanner": "calc_grid_index_from_xy calc_grid_position calc_xy_index is_collision",
    "PRMPlanner": "check_node dijkstra_planning generate_road_map is_collision plot_road_map sample_points",
    **dict.fromkeys(
        ("RRT", "RRTStar", "InformedRRTStar"),
        "AreaBounds Node calc_dist_to_goal calc_distance_and_angle draw_graph get_random_node is_collision steer",
    ),
}

_INTERNAL_REASON = "internal in 2.12; scripts do not need it"
_INTERNAL = (
    "irsim.lib.path_planners.grid_planner_base",
    "irsim.util.decorator",
    "irsim.util.message",
    "irsim.world.map.perlin_map_generator.generate_perlin_noise",
    "irsim.world.object_plot",
)

ABSENT: dict[str, str] = {
    **dict.fromkeys(_INTERNAL, _INTERNAL_REASON),
    "irsim.lib.algorithm.contact": "the core computes contacts: see `irsim.lib.contact_step`, `env.contacts`",
    "irsim.env.env_logger:EnvLogger.CONSOLE_FORMAT": "lines have the same format, but are written without loguru",
    **dict.fromkeys(
        (f"irsim.world.sensors:Contact2D.{name}" for name in ("add", "add_force", "clear", "reset", "tick")),
        "the core writes contacts in each step; read `reports`, `records`, `force`",
    ),
    **{
        f"irsim.lib.path_planners:{planner}.{name}": _SEARCH
        for planner, names in _SEARCH_STEPS.items()
        for name in names.split()
    },
}
"""Name of 2.12 that irsim lacks -> reason."""
