"""A skin of live cells and a PC, on datagrams or serial lines, and what comes in at both ends."""

from innervate.live import files
from tests.livesim.lines import Line
from tests.livesim.stage import Stage
from tests.livesim.world import SECOND, inside

BEACON_US = 200_000
# Longer periods than a skin has, so that more of them fit into a second of this computer.
PROTOCOL = {"beacon_us": BEACON_US, "gap_us": 5000, "skip_us": 120_000}
RATE_HZ = 1.0
AGAIN_S = 60.0  # a cell that starts anew waits 133 periods before it takes a route
FRESH_S = 10.0  # within that time every cell is heard, and hears
BAUD = 115_200
LATELY = 60 * SECOND
WEST, EAST, UP, DOWN = range(4)


class Plan:
    """What a seed stands for; see mesh.Plan."""

    def __init__(self, world, **given):
        chance = world.chance("plan")
        self.columns, self.rows = chance.choice(((2, 2), (3, 2), (3, 3), (4, 3), (4, 5)))
        self.serial = chance.random() < 0.5
        self.sealed = not self.serial and chance.random() < 0.7
        self.hurts = None
        self.storms = chance.randint(1, 3)
        self.storm_s = chance.choice((20, 60))
        self.calm_s = chance.choice((0, 60, 300))
        self.delay_us = (50, 300)
        self.in_c = 0
        self.slow = 1
        self.held_up = world.chance("long stops").random() < 0.15
        if self.held_up:
            self.storm_s = 300
        self.old_lives = False
        for name, value in given.items():
            assert hasattr(self, name), name
            setattr(self, name, value)
        cells = self.columns * self.rows
        self.nodes = cells + 1
        self.links, self.ports = [], [[] for _ in range(self.nodes)]
        for cell in range(cells):
            if cell % self.columns + 1 < self.columns:
                self._join(cell, EAST, cell + 1, WEST)
            if cell + self.columns < cells:
                self._join(cell, DOWN, cell + self.columns, UP)
        self._join(0, WEST, cells, 0)
        self._join(cells - 1, EAST, cells, 1)
        if self.hurts is None and not self.sealed:
            self.hurts = ("lossy", "changing", "cut", "flapping", "partition", "crash", "power",
                          "ended", "restarts", "stall", "clock", "full")  # fmt: skip

    def _join(self, a, port_a, b, port_b):
        self.links.append((a, b))
        self.ports[a].append(port_a)
        self.ports[b].append(port_b)


class Skin(Stage):
    """Cells, and the PC, which is the last node."""

    def __init__(self, world, plan):
        self.lines = {}
        super().__init__(world, plan)
        self.pc = self.hosts[-1]
        self.heard = {}
        self.seen = {}
        self.touches = 0
        self.commands = {}
        self.had = {}
        if plan.serial:
            for k, pair in enumerate(plan.links):
                line = self.lines[pair] = Line(world, BAUD, k)
                self.cables[pair] = (line,)
                for node, end in zip(pair, line.ends, strict=True):
                    self.hosts[node].serial[f"/dev/{k}"] = end

    def name(self, number):
        return "pc" if number == self.plan.nodes - 1 else f"c{number}"

    def file(self, number):
        """The text of a node's file."""
        plan, is_pc = self.plan, number == self.plan.nodes - 1
        head = {"kind": "skin", "name": self.name(number), "number": number,
                "socket": f"/run/{number}.sock", "role": "sink" if is_pc else "cell"}  # fmt: skip
        if not is_pc:
            head |= {"ports": plan.ports[number], "rate_hz": RATE_HZ}
            if plan.in_c and number % plan.in_c == 0:
                head["engine"] = "c"
        return files.text(head, {"protocol": PROTOCOL} | self.key_tables(), self.links(number))

    def links(self, number):
        """A cell's cables, in order of its ports as the plan has them."""
        if not self.plan.serial:
            return super().links(number)
        return [{"kind": "serial", "device": f"/dev/{k}", "baud": BAUD}
                for k, pair in enumerate(self.plan.links) if number in pair]  # fmt: skip

    def listen(self, number, life):
        """What comes in is looked at."""
        if number == self.plan.nodes - 1:
            life.node.receive_touch(lambda touch: self._touched(life, touch))
        else:
            life.node.receive_commands(lambda command: self._commanded(number, life, command))

    def _touched(self, life, touch):
        """A sample is one that a cell took, and came once."""
        if not life.alive:
            return
        if touch.force[0] != touch.cell or touch.cell >= self.plan.nodes - 1:
            self.world.fail(f"{life.name}: {touch}, which no cell took")
            return
        now, cell = self.world.now, self.hosts[touch.cell]
        key = (touch.cell, cell.lives, touch.seq)
        if now - self.seen.get(key, -LATELY) < LATELY and not self._began_lately(cell):
            self.world.fail(f"{life.name}: {touch} twice")
        self.seen[key] = now
        self.heard[touch.cell] = now
        self.touches += 1

    def _began_lately(self, cell):
        return cell.life is None or self.world.now - cell.life.began < LATELY

    def _commanded(self, number, life, command):
        """A command is one that the PC gave, for this cell, and came once."""
        if not life.alive:
            return
        given = self.commands.get(command.number)
        if given is None or (command.code, command.value) not in given:
            self.world.fail(f"{life.name}: {command}, which nobody gave")
        key = (number, life.number, command.number, command.value)
        if key in self.had:
            self.world.fail(f"{life.name}: {command} twice")
        self.had[key] = self.world.now

    def command(self):
        """The PC tells all cells something; its value, -1 = the PC does not run."""
        life = self.pc.life
        if life is None or life.node.engine is None:
            return -1
        value = sum(map(len, self.commands.values()))
        number = (life.node.stack.node.own[0].command + 1) & 65_535
        self.commands.setdefault(number, set()).add((7, value))
        sent = inside(life, life.node.send_command, 7, value)
        assert sent.number == number
        return value

    def sends(self):
        """The PC gives commands now and then, while it may."""
        if self.quiet_since is None:
            self.command()
        self.world.after(self.chance.uniform(1, 8), self.sends)

    def check_reach(self):
        """Every cell is heard, and hears."""
        self.check_running()
        began = self.world.now
        value = self.command()
        self.world.run(FRESH_S)
        for cell in range(self.plan.nodes - 1):
            if self.heard.get(cell, 0) <= began:
                self.world.fail(f"the PC does not hear c{cell}")
            if not any(key[0] == cell and key[3] == value for key in self.had):
                self.world.fail(f"c{cell} does not hear the PC")
        self.world.check()
