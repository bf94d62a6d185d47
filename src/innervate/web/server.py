"""The web server: the page, its files, a run's report, and the socket."""

import asyncio
import re
from contextlib import suppress
from pathlib import Path

from starlette.applications import Starlette
from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from innervate.web.guard import REFUSED, Guard
from innervate.web.hub import Hub

STATIC = Path(__file__).parent / "static"
TRY_LATER = 1013
NAME_MAX = 255  # longer ones no file system has, and asking for them is an error

_PAGE_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",  # the address holds the token
    "Cache-Control": "no-cache",
}
_REPORT_HEADERS = {
    **_PAGE_HEADERS,
    # Somebody else's report is not to become a page of ours.
    "Content-Security-Policy": "sandbox allow-scripts; default-src 'none'; "
    "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:",
}
_NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9_.-]*")


def application(hub: Hub, guard: Guard, report: Path | None = None) -> ASGIApp:
    """The server's application; its caller starts and stops the hub.

    A run's page, the report, is shown to who has the token.
    """

    async def index(_request: Request) -> Response:
        return _file("index.html")

    async def static(request: Request) -> Response:
        return _file(request.path_params["name"])

    async def show_report(request: Request) -> Response:
        if not guard.has_token(request.query_params.get("token", "")):
            return PlainTextResponse("the address lacks the token\n", 403, _PAGE_HEADERS)
        if report is None:
            return PlainTextResponse("there is no report\n", 404, _PAGE_HEADERS)
        return FileResponse(report, headers=_REPORT_HEADERS)

    async def listen(websocket: WebSocket) -> None:
        await websocket.accept()
        given = websocket.query_params.get("token", "")
        if not (guard.is_own_page(websocket.headers) and guard.has_token(given)):
            await websocket.close(REFUSED, "another page, or not the token")
            return
        await _serve(hub, websocket)

    routes = [
        Route("/", index),
        Route("/static/{name}", static),
        Route("/report", show_report),
        WebSocketRoute("/socket", listen),
    ]
    return _Addressed(Starlette(routes=routes), guard)


async def _serve(hub: Hub, websocket: WebSocket) -> None:
    """One page, until it goes."""
    page = hub.enter(websocket.send_text)
    if page is None:
        await websocket.close(TRY_LATER, "too many pages look on")
        return
    telling = asyncio.create_task(page.tell())
    try:
        while (message := await websocket.receive())["type"] != "websocket.disconnect":
            page.take(message.get("text") or message.get("bytes") or b"")
            await asyncio.sleep(0)
    except (WebSocketDisconnect, RuntimeError):
        pass  # gone in the middle of something
    finally:
        hub.leave(page)
        telling.cancel()
        with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError, OSError):
            await telling


def _file(name: str) -> Response:
    path = STATIC / name
    if len(name) > NAME_MAX or not _NAME.fullmatch(name) or not path.is_file():
        what = "the page is not in this installation" if name == "index.html" else "no such file"
        return PlainTextResponse(f"{what}\n", 404, _PAGE_HEADERS)
    return FileResponse(path, headers=_PAGE_HEADERS)


class _Addressed:
    """Answers only who called us by a name of ours."""

    def __init__(self, app: ASGIApp, guard: Guard) -> None:
        self._app = app
        self._guard = guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] in ("http", "websocket"):
            if self._guard.knows(Headers(scope=scope)):
                await self._app(scope, receive, send)
            elif scope["type"] == "http":
                answer = PlainTextResponse("not the name of this server\n", 421, _PAGE_HEADERS)
                await answer(scope, receive, send)
            else:
                await send({"type": "websocket.close", "code": REFUSED})
