# %% [markdown]
# # A skin that loses a cable
#
# A patch of 96 cells with two cables to the PC. One is cut; which cells lose their way, and how
# long until all have another?

# %%
import innervate
from innervate import Skin

skin = Skin(
    name="patch",
    duration_s=3.0,
    patch=[Skin.Patch(columns=12, rows=8)],
    interface=[Skin.Interface(row=0, column=0), Skin.Interface(row=7, column=11)],
    data=Skin.Data(rate_hz=20),
    event=[Skin.Event(at_s=2.0, action="cut", interface=1)],
)
print(innervate.check(skin))

# %%
run = innervate.run(skin)
run

# %% [markdown]
# The keys of the summary are known to editors: `run.skin[` completes them.

# %%
(cut,) = run.skin["recoveries"]
print(f"noticed after {cut['detected_ms']:.1f} ms")
print(f"all cells have a way after {cut['routed_ms']:.1f} ms")

# %%
run.plot("recovery")

# %% [markdown]
# Every change of every cell's route is in a table, for pandas, NumPy or Polars.

# %%
routes = run.pandas("routes")
routes[routes["time_us"] > 2_000_000].head()

# %% [markdown]
# The same skin with less patience: a cell believes a cable broken after two missed beacons, not
# five. `compare` says where the runs part.

# %%
hasty = innervate.run(skin, overrides={"protocol.k": 2})
print(f"all cells have a way after {hasty.skin['recoveries'][0]['routed_ms']:.1f} ms")
print(innervate.compare(run, hasty).divergence)
