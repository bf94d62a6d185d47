# %% [markdown]
# # How fast, depending on two settings
#
# The time until all cells of a skin have a way again, over how often cells beacon and how many
# missed beacons it takes to believe a cable broken.

# %%
import innervate
from innervate import Skin

skin = Skin(
    name="patch",
    duration_s=3.0,
    patch=[Skin.Patch(columns=8, rows=6)],
    interface=[Skin.Interface(row=0, column=0), Skin.Interface(row=5, column=7)],
    event=[Skin.Event(at_s=2.0, action="cut", interface=1)],
)
found = innervate.sweep(
    skin,
    vary={"protocol.beacon_hz": [50, 100, 250], "protocol.k": [2, 3, 4]},
    repeat=10,
    paired="protocol.k",
    workers=2,
)
found

# %%
found.points("recoveries.routed_ms")

# %%
found.plot("protocol.beacon_hz", "recoveries.routed_ms", by="protocol.k")

# %% [markdown]
# Two variants on the same seeds, run by run: how much one more missed beacon costs.

# %%
found.compare("protocol.k", 2, 3, "recoveries.routed_ms")

# %%
found.pandas().groupby(["protocol.beacon_hz", "protocol.k"])["recoveries.routed_ms"].describe()
