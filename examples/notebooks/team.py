# %% [markdown]
# # A team on one radio channel
#
# Eight robots start to send at the same moment. Whoever sends hears nothing, so at first nobody
# receives anything.

# %%
import innervate
from innervate import Radio

team = Radio(name="team", stations=8, duration_s=1.0)
print(innervate.check(team))

# %%
run = innervate.run(team)
run

# %%
run.plot("timeline")

# %% [markdown]
# When every robot always has something to send, what share of the channel carries packets? Beside
# it DCF, the medium access of wireless networks.

# %%
print("share of the channel that carries packets, fairness of the shares")
busy = {"traffic.kind": "saturated", "duration_s": 20.0}
for mac in ("csma-cd-r", "dcf"):
    done = innervate.run(team, overrides={**busy, "protocol.mac": mac})
    print(f"{mac:10} {done.radio['throughput']:.1%}  {done.radio['jain']:.3f}")
