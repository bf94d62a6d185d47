"""The labels of our readings of the skin paper: E1 to E34, and the fixes F1 to F3, a sentence each.

The page of the paper links every label to its sentence; docs/readings.md lists them.
"""

from innervate.papers.words import sentences

READINGS = sentences(
    """
E1: Algorithm 1, line 20 sends the number of the parent's route, Sq(p_m); the printed S(p_m) is a
slip, S being the size of a subnetwork.
E2: Algorithm 1, line 12 is a difference of sets: candidates are the active ports without the
children's, and without broken ones.
E3: A cell knows its children because beacons carry a bit for each port, "you are my parent";
nothing else could tell, as beacons go to all ports.
E4: Beacons carry the load L and the subnetwork's size S; the PC starts S by sending back on each
interface port the load last heard there.
E5: A cell loses its parent when that port is broken, says infinity, or names the cell its own
parent; the number of the lost route is kept for comparison.
E6: Both branches of Algorithm 2 test the sequence number before the new port is taken; printed,
one of them never takes its port.
E7: Without a better port the parent is kept; printed, a cell whose only route is its parent would
give it up every period.
E8: Ports that fail the test of the number are left out before the nearest is looked for; else a
stale near port hides a fresh far one.
E9: A parent whose distance grows is no failure: it stays until an allowed port is nearer.
E10: A cell with another allowed port changes to it in the same period and announces infinity only
if none is left.
E11: Algorithm 3's loop never removes a candidate and would not end; the one with the least
subnetwork is tested, once.
E12: Algorithm 3 has its sign reversed: a move evens the loads out if the own subnetwork is larger
than the other by more than the cell's load.
E13: Equation 2 has the same reversed sign: a move is forbidden unless that holds.
E14: Many cells can be equally far from two roots, so n_bal is no bound; an attempt every 8 d_max
periods, drawn anew after a move, settles.
E15: In one patch, interface ports an odd number of hops apart leave no cell a choice, and
balancing can do nothing.
E16: A port is broken from p_f = 1 on, so that k beacons missed in a row break it; with the
printed "exceeds" it would be k + 1 where 1/r_f is whole.
E17: The penalty is increased by r_f, and r_f and r_r are chosen, where p_f is printed.
E18: What counts is whether any beacon came within the cell's own period: clocks run freely, so
that none or two can come in one.
E19: From its greatest penalty a port works again after the beacons that bring it below 1, k + 1
for r_f = r_r = 1/k; there is no hysteresis.
E20: That routes are found within max(H) periods holds for a start-up in lock-step; a recovery has
to go out and come back, k + 2 (d_m - 1) periods in lock-step.
E21: Equation 7 is a mean with a band, not a bound: free-running cells converge one period a hop
after a detection that takes k periods on the mean, k - 1 to k + 1.
E22: ceil(h/2) is the depth on the path between the interface ports; other cells lie deeper.
E23: Convergence is the last change of a parent after the failure; the delay of its report is
subtracted once.
E24: h counts the cells on the shortest path between the interface ports, both ends included.
E25: The printed rule, a number at least the parent's, closes forwarding loops: while a failure is
being detected all cells beyond it end with the same number, and equal ones pass.
E26: The test of the number also keeps out healthy ports that are nearer but whose number always
comes later, so that longer routes can stay.
E27: Numbers have 16 bits and wrap; a PC that starts listens for k periods and goes on from the
newest number it hears; a cell long without a route forgets its feasible distance.
E28: Equation 9 gives 0.06 % at 10 Hz and 0.6 % at 100 Hz; the printed numbers are ten times that.
E29: "At most 50 ms" and "40 ms" name no k: 40 ms is Equation 4's mean at k = 3, 50 ms the upper
end of its band at k = 2 to 3.
E30: The arm's 500 ms at 20 Hz and k = 8 fit a shallow skin, d_m about 2 or 3; setup 1 would take
750 ms.
E31: In Equation 8 k is the number of interface ports, x_i the ports.
E32: "About 30 % in setup 2" must mean one of the setups 5 to 7; 1 to 4 are those of the recovery.
E33: Infinity is the number 255, and routes of more than max_depth hops (64) are not taken, which
ends counting upwards.
E34: The networks of setups 5 to 7 are not published; ours have more than 66 cells a port, and
ports placed so that balancing is possible.
F1: Rule strict: once the parent is lost, a number newer than the lost route's is required.
F2: Rule feasible, the default: a new parent must be newer, or as new and nearer, than the nearest
this cell ever announced; no loop can close.
F3: The PC counts its number up every min(k, 5) periods instead of every period, which takes the
longer routes of E26 away but prevents no loop by itself.
"""
)
