"""What must hold of ALOHA."""


def node_tries_only_what_it_was_given(node, params, now):
    """A node counts tries of more than a message may have"""
    return node.tries <= 8
