"""How fast live networks heal: innervate beside a routing daemon, in network namespaces."""
