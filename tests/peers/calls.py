"""One call of each tool that shows what it answers, shared by the clients; standard library only."""

ROOM = """\
world: {width: 8, height: 6}
robot:
  - {kinematics: {name: diff}, state: [1, 1, 0], goal: [4, 3, 0], behavior: {name: dash}}
"""
FIRST = (
    ("lookup", {"topic": "dash"}),
    ("validate_scenario", {"scenario_yaml": ROOM}),
    ("render_snapshot", {"scenario_yaml": ROOM, "size_px": 200}),
    ("run_episode", {"scenario_yaml": ROOM, "seed": 1}),
    ("benchmark", {"scenarios": [ROOM], "behaviors": ["dash"], "seeds": 2, "wait_s": 40}),
)


def after(run_id: str, job_id: str) -> tuple[tuple[str, dict[str, object]], ...]:
    """Calls that need what others have made."""
    return (
        ("inspect_run", {"run_id": run_id}),
        ("export_run", {"run_id": run_id, "to": "csv"}),
        ("get_job", {"job_id": job_id, "wait_s": 1}),
        ("write_scenario", {"path": "room.yaml", "yaml": ROOM, "overwrite": True}),
    )
