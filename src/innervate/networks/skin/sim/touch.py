"""What a cell's sensors say: a synthetic touch that moves over the skin, and the robot at rest.

All integers: the touch's place per step (um), its span (radius um, force mN, step us) and every
cell's place (um) are worked out before the run.
"""

RADIUS = 0
FORCE = 1
STEP = 2
ONE_G = 256  # acceleration at rest, raw


def read_sensors(world, node, time):
    """Fill world.sample[0] with what `node` measures at true time `time` (us)."""
    sample = world.sample[0]
    sample.proximity = 0
    sample.temperature = 4
    pressed = 0
    steps = len(world.touch_x)
    if steps > 0:
        at = min(time // world.touch_span[STEP], steps - 1)
        radius = world.touch_span[RADIUS]
        dx = (world.place[2 * node] - world.touch_x[at]) // 10
        dy = (world.place[2 * node + 1] - world.touch_y[at]) // 10
        near = radius // 10
        apart = dx * dx + dy * dy
        if apart < near * near:
            share = ((near * near - apart) << 10) // (near * near)
            pressed = (world.touch_span[FORCE] * share) >> 10
        if apart < 4 * near * near:
            sample.proximity = (4 * near * near - apart) * 4095 // (4 * near * near)
    for i in range(3):
        sample.force[i] = pressed
        sample.accel[i] = 0
    sample.accel[2] = ONE_G
