"""An MCP server of an office that has nothing to do with scenarios: its tools work, but do not help.

``python -m irsim_evals.harness.distractors`` serves over standard input and output. Everything is made up and kept in
memory, so that the same calls have the same answers.
"""

from __future__ import annotations

from typing import Any

from mcp.server import MCPServer

__all__ = ["build_office"]

_LENGTHS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "ft": 0.3048, "in": 0.0254, "mi": 1609.344}
_SHIFTS_H = {"UTC": 0, "CET": 1, "EST": -5, "PST": -8, "JST": 9, "CST": 8}
_CONTACTS = {"Ada Brandt": "facilities", "Bo Chen": "robotics", "Carla Diaz": "purchasing", "Dev Patel": "robotics"}
_PRICES = {"lidar": 1290.0, "battery": 210.5, "wheel": 34.9, "bumper": 58.0, "charger": 149.0}


def build_office() -> MCPServer[Any]:
    """The server with a dozen tools."""
    server: MCPServer[Any] = MCPServer("office", instructions="Calendar, issues, notes and purchasing of the office.")
    events: list[str] = ["Monday 09:00 stand-up", "Tuesday 14:00 review of the warehouse layout"]
    issues: dict[int, list[str]] = {
        101: ["Robot stops at the dock door"],
        102: ["Map of hall B is out of date"],
        103: ["Lidar of unit 7 reports short ranges"],
    }
    notes: list[str] = ["Hall B: corridor is 2.4 m wide", "Charging dock moves next month"]

    def calendar_list_events() -> list[str]:
        """List the events of this week."""
        return events

    def calendar_create_event(title: str, when: str) -> str:
        """Add an event to the calendar."""
        events.append(f"{when} {title}")
        return f"created: {when} {title}"

    def convert_units(value: float, source: str, target: str) -> str:
        """Convert a length between m, cm, mm, km, ft, in and mi."""
        if source not in _LENGTHS_M or target not in _LENGTHS_M:
            return f"unknown unit; there are {', '.join(_LENGTHS_M)}"
        return f"{value * _LENGTHS_M[source] / _LENGTHS_M[target]:.6g} {target}"

    def convert_time_zone(hour: int, source: str, target: str) -> str:
        """Convert an hour of the day between UTC, CET, EST, PST, JST and CST."""
        if source not in _SHIFTS_H or target not in _SHIFTS_H:
            return f"unknown zone; there are {', '.join(_SHIFTS_H)}"
        return f"{(hour - _SHIFTS_H[source] + _SHIFTS_H[target]) % 24:02d}:00 {target}"

    def issue_search(words: str) -> list[str]:
        """Search the issue tracker of the robotics team."""
        wanted = words.lower().split()
        return [f"#{key} {texts[0]}" for key, texts in issues.items() if any(w in texts[0].lower() for w in wanted)]

    def issue_create(title: str) -> str:
        """Create an issue."""
        key = max(issues) + 1
        issues[key] = [title]
        return f"created #{key}"

    def issue_comment(number: int, text: str) -> str:
        """Comment on an issue."""
        if number not in issues:
            return f"there is no issue #{number}"
        issues[number].append(text)
        return f"#{number} has {len(issues[number]) - 1} comments"

    def contact_find(name_or_team: str) -> list[str]:
        """Find a colleague by name or team."""
        wanted = name_or_team.lower()
        return [f"{name}, {team}" for name, team in _CONTACTS.items() if wanted in f"{name} {team}".lower()]

    def note_add(text: str) -> str:
        """Save a note."""
        notes.append(text)
        return f"saved as note {len(notes)}"

    def note_search(words: str) -> list[str]:
        """Search the saved notes."""
        wanted = words.lower().split()
        return [note for note in notes if any(word in note.lower() for word in wanted)]

    def part_price(part: str) -> str:
        """Look up the price of a robot part."""
        price = _PRICES.get(part.lower())
        return f"{price:.2f} EUR" if price else f"unknown part; there are {', '.join(_PRICES)}"

    def floor_plan_request(building: str, hall: str) -> str:
        """Ask facilities for the floor plan of a hall; it is sent within two working days."""
        return f"request for hall {hall} of {building} is queued"

    def robot_booking(robot: str, day: str) -> str:
        """Book one of the real robots of the laboratory for a day."""
        return f"{robot} is booked on {day}"

    for work in (
        calendar_list_events, calendar_create_event, convert_units, convert_time_zone, issue_search, issue_create,
        issue_comment, contact_find, note_add, note_search, part_price, floor_plan_request, robot_booking,
    ):  # fmt: skip
        server.add_tool(work)
    return server


if __name__ == "__main__":
    build_office().run("stdio")
