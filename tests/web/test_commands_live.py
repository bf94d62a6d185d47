"""Commands that a page has the PC of running cells send down, over real nodes and their sockets."""

import asyncio
import tempfile
from contextlib import AsyncExitStack
from pathlib import Path

from innervate.live import status
from innervate.web.live import Live
from innervate.web.serve import serving
from tests.live.net import Skin
from tests.web.page import Page


def server(node, folder):
    """The status socket of a node, as far as a page asks."""

    async def answer(request, writer):
        asked = node.requests.get(request["do"])
        try:
            await writer.line(asked(request) if asked else node.status())
        except ValueError as error:
            await writer.line({"error": str(error)})

    return status.Server(folder / f"{node.name}.sock", answer)


async def watched(skin, folder, stack):
    """The skin as a page finds it: by its nodes' sockets, which the stack closes."""
    servers = [server(node, folder) for node in (*skin.cells, skin.pc)]
    for one in servers:
        await one.start()
        stack.push_async_callback(one.stop)
    return await asyncio.to_thread(Live, [one.path for one in servers])


def test_a_command_goes_from_the_page_through_the_skin_and_is_shown_where_it_came():
    async def main(folder, stack):
        skin = await stack.enter_async_context(Skin(3, 1, [(0, 0)], rate_hz=20.0))
        heard = [[] for _ in skin.cells]
        for cell, list_ in zip(skin.cells, heard, strict=True):
            cell.receive_commands(list_.append)
        source = await watched(skin, folder, stack)
        async with serving(source) as served, Page(served.address) as page:
            await page.take()
            assert "command" in page.scene["can"]
            await page.until(lambda: page.state.get("unconnected") == 0)
            assert page.state["told"] == [-1, -1, -1, -1]
            await page.give("command", node=2, code=7, value=500)
            await page.until(lambda: page.state["told"][2] >= 0)
            (alone,) = heard[2]
            assert (alone.code, alone.value, alone.to_all) == (7, 500, False)
            assert (page.state["told"][2], alone.hops) == (alone.number, 2)
            assert page.state["told"][:2] == [-1, -1]
            assert heard[0] == heard[1] == []
            await page.until(lambda: f"command {alone.number} came to c2" in page.text())
            await page.give("command", code=8)
            await page.until(lambda: page.state["told"][:3] == [(alone.number + 1) % 65536] * 3)
            assert [list_[-1].code for list_ in heard] == [8, 8, 8]
            await page.until(lambda: "came to all 3 cells" in page.text())
            refused = await page.ask("command", node=3, code=1)
            assert "port of the PC" in refused["text"]

    async def whole(folder):
        async with AsyncExitStack() as stack:
            await main(folder, stack)

    with tempfile.TemporaryDirectory(prefix="iv") as folder:
        asyncio.run(whole(Path(folder)))


def test_a_command_that_no_cell_hands_down_is_refused_and_said():
    """The only cable is cut at the PC before anybody became its child."""

    async def main(folder):
        async with Skin(2, 1, [(0, 0)]) as skin, AsyncExitStack() as stack:
            for path in skin.cables["pc", 0]:
                path.cut = True
            source = await watched(skin, folder, stack)
            async with serving(source) as served, Page(served.address) as page:
                await page.take()
                refused = await page.ask("command", code=1)
                assert "no cell has the PC as its parent" in refused["text"]

    with tempfile.TemporaryDirectory(prefix="iv") as folder:
        asyncio.run(main(Path(folder)))
