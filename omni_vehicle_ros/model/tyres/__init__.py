"""Tyres: laws that share their stiffness and friction, behind one interface, `force`.

Slip comes as the contact's velocity in the wheel frame, (v_long, v_lat): tan(side slip) = -v_lat / abs(v_long).
A positive side slip makes a positive (leftward) force, and a wheel that rolls backward is a mirror image of one
that rolls forward. No function here divides by a speed, so that standstill is no special case.

The laws take the slips as velocities over a rolling speed, which is that of the rim: the theoretical slips of
Pacejka 2012, sec. 3.2.3, ``sigma = (slip_long, slip_lat) / rolling``, with slip_long = rim speed - v_long and
slip_lat = -v_lat. Of a wheel that rolls freely sigma is (0, tan(alpha)). Dugoff's tyre takes the slip ratio.
"""
