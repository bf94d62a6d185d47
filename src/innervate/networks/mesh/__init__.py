"""The mesh of robots and posts: routed messages, and a virtual fence on top."""
