"""Who may look on and command: the token, the page's own origin, and no name that we do not know.

A page of somebody else's, open in the same browser, can reach this server. It cannot know the
token, it cannot hide its origin, and a name that it has lead here (DNS rebinding) is not ours.
"""

import os
import secrets
from collections.abc import Mapping

from innervate.live.hosts import OwnNames

TOKEN_BYTES = 18
TOKEN_GIVEN = "INNERVATE_WATCH_TOKEN"  # so that pages know a server that was started anew
REFUSED = 4403  # close code of a socket


class Guard:
    """The checks of one server; `host` is what it was told to bind to."""

    def __init__(self, host: str) -> None:
        self.token = os.environ.get(TOKEN_GIVEN) or secrets.token_urlsafe(TOKEN_BYTES)
        self._names = OwnNames(host)

    def knows(self, headers: Mapping[str, str]) -> bool:
        """True if a request is addressed to us: by number, or by a name of ours."""
        return self._names.hold(headers.get("host", ""))

    def is_own_page(self, headers: Mapping[str, str]) -> bool:
        """True if no page, or one that we served, is behind a request."""
        origin = headers.get("origin")
        return origin is None or origin.lower() in (
            f"http://{headers.get('host', '').lower()}",
            f"https://{headers.get('host', '').lower()}",
        )

    def has_token(self, given: str) -> bool:
        """True if that is the token."""
        return secrets.compare_digest(given.encode(), self.token.encode())
