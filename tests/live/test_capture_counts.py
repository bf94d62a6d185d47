"""What a capture says of nodes that tell more than it can take, and of one without paths."""

import asyncio
import io
import json

from innervate.cli.capturing import Recorder
from innervate.live import tap
from tests.live.net import Mesh

ABOUT = {"capturing": "n0", "kind": "mesh", "role": "node", "number": 0, "sealed": True,
         "paths": [[0, 0, "here", "there"]]}  # fmt: skip
FRAME = [2**62, 0, True, "00ff", ""]


def captured(tmp_path, *lines):
    """What is said at the end of a capture of one node that tells these lines, and is gone."""

    async def tell(_reader, writer):
        for line in (ABOUT, *lines):
            writer.write(json.dumps(line).encode() + b"\n")
        writer.close()
        server.close()
        await asyncio.to_thread((tmp_path / "n0.sock").unlink, missing_ok=True)

    async def main():
        nonlocal server
        server = await asyncio.start_unix_server(tell, tmp_path / "n0.sock")
        return await Recorder([tmp_path / "n0.sock"], io.BytesIO()).run(5.0)

    server = None
    return asyncio.run(main())


def test_frames_that_came_too_fast_are_counted_and_said(tmp_path, capsys):
    told = [{"frames": [FRAME], "missed": 3}, {"frames": [FRAME, FRAME], "missed": 4}]
    assert captured(tmp_path, *told) == 0
    said = capsys.readouterr().err
    assert (
        said == "innervate: 3 frames of 1 node; 7 more came too fast; opened: sealed ones of n0\n"
    )
    captured(tmp_path, {"frames": [FRAME], "missed": 0})
    assert "too fast" not in capsys.readouterr().err


def test_a_node_without_paths_has_one_interface_at_port_0():
    node = Mesh(2, []).nodes[1]
    assert tap.about(node) == {
        "capturing": "n1", "kind": "mesh", "role": "node", "number": 1, "sealed": False,
        "paths": [(0, 0, "", "")],
    }  # fmt: skip
