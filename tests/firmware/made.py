"""C of the roles with their usual parameters: half a second for a mesh, so each is made once."""

from functools import cache

from innervate.firmware import library


@cache
def files_of(role, sealed=False):
    """A role's files; the protocol in them is the same whether its driver seals or not."""
    if not sealed:
        return library.made_of(role, [])
    plain, (network, _) = files_of(role).library, library.role_of(role)
    return library.Files(plain, library.files_of(plain, network, sealed=True))
