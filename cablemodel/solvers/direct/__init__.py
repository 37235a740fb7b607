"""The method of Sun & Leonard 1998: implicit steps in time, initial value problems along the cable.

An independent second solver of the same scenes, see docs/theory.md. Misprints in the paper:

1. Eq. 10 is singular at theta = n pi, not psi = n pi.
2. "k3 is constant" holds for the twist of the material; with psi = 0, k3 = k2 cot theta is a rate
   of the frame, and B(3) k3 in eq. 27 must not make a moment.
3. Eq. 22: weight per unstretched length is not multiplied by e.
4. Eq. 23: added mass takes the full normal acceleration, not the rate of a component.
5. Eqs. 16, 27: factors e are missing on the v_p terms.
6. Eq. 40: reversing section B needs phi + pi and theta -> pi - theta; with negative ds no change of
   axes is needed at all (here B is simply swept from its end).
7. Eqs. 44, 45: "(48)" means (43).
8. Section 4.3: v.n = 0 is the time derivative of (34) given a3.n = 0, so it is redundant.
9. Eq. 31: the last term is omega x H.
"""
