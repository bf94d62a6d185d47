"""What a cell's sensors say: a synthetic touch that moves over the skin, and the robot at rest.

All integers: the touch's place per step (um), its span (radius um, force mN, step us) and every
cell's place (um) are worked out before the run.
"""

from innervate.dialect.arith import MASK30

RADIUS = 0
FORCE = 1
STEP = 2
ONE_G = 256  # acceleration at rest, raw


def read_sensors(world, node, time):
    """Fill world.sample[0] with what `node` measures at true time `time` (us)."""
    sample, touch = world.sample[0], world.carrier
    sample.made_at = time & MASK30
    sample.proximity = 0
    sample.temperature = 4
    pressed = 0
    steps = len(touch.x)
    if steps > 0:
        at = min(time // touch.span[STEP], steps - 1)
        radius = touch.span[RADIUS]
        dx = (touch.place[2 * node] - touch.x[at]) // 10
        dy = (touch.place[2 * node + 1] - touch.y[at]) // 10
        near = radius // 10
        apart = dx * dx + dy * dy
        if apart < near * near:
            share = ((near * near - apart) << 10) // (near * near)
            pressed = (touch.span[FORCE] * share) >> 10
        if apart < 4 * near * near:
            sample.proximity = (4 * near * near - apart) * 4095 // (4 * near * near)
    for i in range(3):
        sample.force[i] = pressed
        sample.accel[i] = 0
    sample.accel[2] = ONE_G
