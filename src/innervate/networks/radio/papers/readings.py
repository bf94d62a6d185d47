"""The labels of our readings of the radio paper (Q) and of what we found (F), a sentence each."""

from innervate.papers.words import sentences

READINGS = sentences(
    """
Q1: A packet costs one slot more than it has: reading A waits for the end of a slot, reading B
sends packets back to back and pays a slot for each CR-R.
Q2: T_c0 is how much later the last colliding station ends than the one before it.
Q3: In the slotted model the order after a collision is given, as a random permutation.
Q4: T_cn and T - T_c0 count from the end of the first CR-R that was received.
Q5: The window does not start anew with each CR-R.
Q6: Near ties of two stations are ordered exactly by rules T1 and T4, those of more by T2.
Q7: Who arrives during a resolution waits for it to end.
Q8: Carriers are counted, not decoded frames, so that garbled CR-Rs change nothing.
Q9: The turn of a robot that died passes after a dead turn; a lost reporter can lose the last
robot's packet silently.
Q10: A robot that joins first listens for a packet and a dead turn of silence, or follows one
reservation.
Q11: Hidden terminals are outside the paper's assumptions; what they do is measured.
Q12: A turn's packet that only one robot could not read is counted as a turn (rule N2).
Q13: How long a station verifies is the guard G; the printed T_cn is not known to the last.
Q14: "CSMA/CD" is read as Ethernet's truncated binary backoff with a collision of one slot (D1),
or of a whole packet (D2).
Q15: That T_D of CSMA/CD grows with the square of n holds for none of Ethernet's backoffs.
Q16: Fig. 12's packets of 25 slots are read in three ways: X1 switching comes on top, X2 it is in
them, X3 packets of 5 slots and switching on top.
Q17: A broadcast packet with an error is not sent again: its sender never knows.
F1: With carrier sense and packets of one length all that collide start within one propagation
delay, so that the CR-Rs of the third and later stations overlap: a reservation orders four
stations at most.
F2: With 2 ms of switching taken literally collisions go unnoticed and packets are lost in
silence.
F3: CSMA/CD's advantage with few stations is capture: one station keeps the channel.
F4: No synchronisation is needed on a real medium; 0.83 and 0.96 come from slots.
F5: Throughput above 30 stations is constant within 5 %, not flat.
"""
)
