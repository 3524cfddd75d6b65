"""The studio: a page with the text and the scene of a scenario side by side, served to this machine."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

import anyio.to_thread
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from irsim.bundled import templates
from irsim.diagnostics.errors import IrsimError
from irsim.graphics.scene.theme import css_variables
from irsim.policies.description import list_policies
from irsim.runs.reading import open_run
from irsim.runs.replay.page import WEB as PLAYER
from irsim.runs.replay.page import player
from irsim.studio.feed import Feed
from irsim.studio.live import stream
from irsim.studio.server import Refused, Server, given
from irsim.studio.workers import TooSlow, Worker
from irsim.studio.workspace import FileChanged, FileRefused, Workspace

__all__ = ["Studio"]

_WEB = Path(__file__).with_name("web")
_KINDS = {".js": "text/javascript", ".css": "text/css", ".txt": "text/plain"}
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self'; form-action 'none'; frame-ancestors 'none'; base-uri 'none'"
)
"""CodeMirror writes its style sheets from its script."""
_MOST = 2_000_000
"""Size of the largest body with a text [bytes]."""
_KEYS = ("text", "seed", "seeds", "steps", "policy", "edits", "line", "column")
"""Keys of a job that the page may write."""
_NOT_OFFERED = ("replay", "mixed", "process", "neupan", "rl_rvo_authors")
"""Policies that need options or programs, which a scenario names."""
_CHECK_S, _RUN_S = 20.0, 120.0
"""Longest time of a check or an edit, and of a run [s]."""


class Studio:
    """The studio of one folder: its server, its files and the processes that compute.

    Args:
        root: Folder of the files; nothing outside of it is read or written.
        port: Port of the server; 0 chooses a free one.
        first: The scenario that the page opens: a file by ``name``, a ``template``, or a ``run`` by its id; None: the
            page chooses.

    Raises:
        InputError: The port cannot be used.
    """

    def __init__(self, root: Path, port: int = 0, first: Mapping[str, str] | None = None) -> None:
        self.files = Workspace(root)
        self._first = first
        self._reader, self._runner = Worker(self.files.root), Worker(self.files.root)
        self._run: Feed | None = None
        tasks: dict[str, Callable[[dict[str, Any]], Any]] = {
            "/files": self._list,
            "/open": self._open,
            "/save": self._save,
            "/check": partial(self._ask, "check"),
            "/edit": partial(self._ask, "edit"),
            "/complete": partial(self._ask, "complete"),
            "/page": self._export,
        }
        routes = [
            Route("/", self._page, methods=["GET"]),
            Route("/web/{name:path}", _part, methods=["GET"]),
            *(Route(path, partial(_answered, task), methods=["POST"]) for path, task in tasks.items()),
            Route("/run", self._start, methods=["POST"]),
        ]
        texts = dict.fromkeys([*tasks, "/run"], _MOST)
        self._server = Server(port, routes, texts, opened=("/web/",))
        self.address = self._server.address

    def show(self) -> None:
        """Open the page in a browser, if there is one."""
        self._server.show()

    def close(self) -> None:
        """End the server and the processes."""
        if self._run is not None:
            self._run.close()
        self._server.close()
        for worker in (self._reader, self._runner):
            worker.close()

    async def _page(self, _: Request) -> Response:
        frame = (_WEB / "studio.html").read_text(encoding="utf-8")
        page = frame.replace("{{player}}", player())
        return HTMLResponse(page, headers={"Content-Security-Policy": _POLICY})

    def _list(self, _: dict[str, Any]) -> Any:
        kinds = [{"name": one.name, "title": one.title} for one in templates.load_all()]
        drivers = [{"name": one.name, "about": one.about} for one in list_policies() if one.name not in _NOT_OFFERED]
        known = {"files": self.files.names(), "templates": kinds, "policies": drivers}
        return {**known, "first": self._first, "folder": str(self.files.root)}

    def _open(self, wanted: dict[str, Any]) -> Any:
        if (name := wanted.get("template")) is not None:
            if name not in templates.names():
                raise Refused(404, f"there is no template '{name}'")
            return {"name": f"{name}.yaml", "text": templates.scenario_file(name).read_text("utf-8"), "mark": None}
        if (run := wanted.get("run")) is not None:
            opened = open_run(str(run), self.files.root)
            about = {"name": f"{opened.id}.yaml", "text": opened.scenario_text, "mark": None}
            return {**about, "seed": int(opened.meta["seed"])}
        text, mark = self.files.read(_text(wanted, "name"))
        return {"name": wanted["name"], "text": text, "mark": mark}

    def _save(self, wanted: dict[str, Any]) -> Any:
        try:
            return {"mark": self.files.write(_text(wanted, "name"), _text(wanted, "text"), wanted.get("mark"))}
        except FileChanged as changed:
            return {"why": str(changed), "text": changed.text}

    def _ask(self, task: str, wanted: dict[str, Any]) -> Any:
        return self._reader.ask(task, _CHECK_S, **self._job(wanted))

    def _export(self, wanted: dict[str, Any]) -> Any:
        return self._runner.ask("page", _RUN_S, **self._job(wanted))

    def _job(self, wanted: dict[str, Any]) -> dict[str, Any]:
        """A job as the page may describe it, for the text of a file of the folder, or for a new text."""
        _text(wanted, "text")
        job = {key: value for key, value in wanted.items() if key in _KEYS}
        name = wanted.get("name")
        return job if name is None else {**job, "path": self.files.path_of(_text(wanted, "name"))}

    async def _start(self, request: Request) -> Response:
        job = self._job(await given(request))
        if self._run is not None and not self._run.closed:
            self._runner.stop()  # the newest run is wanted
        self._run = feed = Feed()
        self._runner.run(feed, _RUN_S, **job)
        return stream(feed, 0)


async def _answered(task: Callable[[dict[str, Any]], Any], request: Request) -> Response:
    wanted = await given(request)
    try:
        return JSONResponse(await anyio.to_thread.run_sync(task, wanted))
    except (FileRefused, IrsimError, TooSlow, ValueError) as error:
        return JSONResponse({"why": str(error)})


@cache
def _parts() -> dict[str, Path]:
    """Address below ``/web/`` -> file, of the modules and style sheets; the studio's go before the player's."""
    files = {file.relative_to(folder).as_posix(): file for folder in (PLAYER, _WEB) for file in folder.rglob("*")}
    return {name: file for name, file in files.items() if file.suffix in _KINDS}


async def _part(request: Request) -> Response:
    """A module or a style sheet of the page."""
    name: str = request.path_params["name"]
    if name == "theme.css":
        return Response(css_variables(), media_type="text/css")
    if (file := _parts().get(name)) is None:
        raise Refused(404, "there is nothing at this address")
    return Response(file.read_bytes(), media_type=_KINDS[file.suffix])


def _text(wanted: dict[str, Any], key: str) -> str:
    value = wanted.get(key)
    if not isinstance(value, str):
        raise Refused(400, f"write {json.dumps({key: '…'}, ensure_ascii=False)}")
    return value
