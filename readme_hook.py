"""What a package index shows of the README: addresses of the project, and pictures that are found.

Where the project lies on the web stands nowhere in it: INNERVATE_ADDRESS says so when it is built
(`make dist ADDRESS=https://...`). Without it the page has no pictures, rather than broken ones.
"""

import os
import re
from pathlib import Path

from hatchling.metadata.plugin.interface import MetadataHookInterface

PICTURE = re.compile(r"!\[[^\]]*\]\((?P<to>[^)]+)\)|<img src=\"(?P<at>[^\"]+)\"[^>]*>")
LINK = re.compile(r"(?<!!)\[(?P<what>[^\]]*)\]\((?P<to>(?!https?:|#)[^)]+)\)")


class Addresses(MetadataHookInterface):
    """Sets `readme` and `urls`."""

    def update(self, metadata):
        """As the core metadata are gathered."""
        address = os.environ.get("INNERVATE_ADDRESS", "").rstrip("/")
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": outside(text, address)}
        metadata["urls"] = urls(address)


def urls(address):
    """The project's addresses, by what a package index calls them."""
    if not address:
        return {}
    if not re.fullmatch(r"https://[\w.-]+(/[\w.~-]+)+", address):
        raise ValueError(f"INNERVATE_ADDRESS must be like https://HOST/OWNER/NAME, not {address!r}")
    return {
        "Source": address,
        "Documentation": f"{address}/blob/HEAD/docs/index.md",
        "Changelog": f"{address}/blob/HEAD/CHANGELOG.md",
        "Issues": f"{address}/issues",
    }


def outside(text, address):
    """The README as it can be read outside the repository; "" = nobody knows where that lies."""
    if not address:
        return LINK.sub(r"\g<what>", PICTURE.sub("", text))

    def whole(found):
        to = found["to"] or found["at"]
        return found[0].replace(to, f"{address}/raw/HEAD/{to}")

    text = PICTURE.sub(whole, text)
    return LINK.sub(lambda found: f"[{found['what']}]({address}/blob/HEAD/{found['to']})", text)
