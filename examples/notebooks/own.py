# %% [markdown]
# # A network of one's own
#
# A folder is a network. The command writes one that works; `protocol.py` in it is the place for
# your idea.

# %%
from pathlib import Path

import innervate
from innervate.cli import main

main(["new", "network", "ring"])
print(*sorted(path.name for path in Path("ring").iterdir()))

# %%
print(Path("ring/protocol.py").read_text())

# %% [markdown]
# `use` makes it known; from then on its name is a kind like any other.

# %%
innervate.use(Path("ring"))
ring = innervate.CablesScenario(kind="ring", nodes=6, shape="ring", duration_s=2.0)
run = innervate.run(ring, plain=True)
run

# %% [markdown]
# Every order of events on small graphs, not only those that a simulation meets:

# %%
for case in innervate.explore("ring", states=500):
    print(*case.lines, sep="\n")

# %% [markdown]
# And the same source between real processes:

# %%
with innervate.live_up(ring) as nodes:
    print(nodes)
    print({name: len(told["paths"]) for name, told in nodes.status().items()})  # paths of each
