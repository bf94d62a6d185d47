"""`innervate live`: what the commands do."""

from __future__ import annotations
