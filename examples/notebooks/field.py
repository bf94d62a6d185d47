# %% [markdown]
# # A robot leaves its fence
#
# Posts and a robot in a field, which pass on each other's messages. Three posts die and nobody is
# told; then the robot walks out.

# %%
import innervate
from innervate import Mesh

field = Mesh(
    name="field",
    seed=4,
    nodes=16,
    duration_s=30.0,
    radio=Mesh.Radio(mean_degree=6.0),
    placement=Mesh.Placement(layout="random", side_m=60.0),
    fence=Mesh.Fence(polygon=[(5, 5), (55, 5), (55, 55), (5, 55)]),
    robot=[Mesh.Robot(node=15, waypoints=[(30, 30), (30, 62)], speed_mps=4.0, start_s=20.0)],
    event=[Mesh.Event(at_s=19.0, action="kill", random=3)],
)
print(innervate.check(field))

# %%
run = innervate.run(field)
run

# %%
run.plot("field")

# %%
alarms = run.mesh["alarms"]
print(f"{alarms['delivered']} of {alarms['sent']} alarms reached the monitor")
print(f"the slowest after {alarms['latency_ms']['max']:.1f} ms")
print(f"the robot got {alarms['overrun_m']['max']:.2f} m out")
