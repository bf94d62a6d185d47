"""What only one kind of network can do, for programs; `innervate` hands these names on."""

from innervate.networks.skin.sizing import Answer, Question, size

__all__ = ["Answer", "Question", "size"]
