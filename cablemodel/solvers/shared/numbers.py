"""Numbers that steer several parts of the engine, each in one place."""

PROMISE = 10.0  # in tau: what tensions may be wrong by, of the largest one in their line
COMMON_TOLERANCE = 1e-3  # tau at which numbers hold that change with it
FINEST_TOLERANCE = 1e-12  # in its place where one is finer, or none
SHORTEST_LINE = 0.01  # of the initial length: what reel-in leaves out
TAKES_OFF = 3.0  # speed over what the floor's layer takes off it: depth, damping, gravity
LYING = 0.2277  # of the contact layer: the gap where a taut cable would touch a rigid floor
OUT_OF_PLANE = 1e-12  # of a horizontal vector: what is across a plane, and still counts as in it
SLOPE_WEIGHT = 0.3  # of an element's length: what a turn of a slope counts as a motion
END_BEND = 0.25  # of what r'' changes by in an element at an end: its jump beside others

# Of static shapes: how their mesh is refined, and the floors on which they are sought.
REFINEMENT_ROUNDS = 14  # times that a mesh is refined at most
REFINEMENT_BENT = 2.5  # of tau L: what h^2 times the jump of curvature may be in a static shape
REFINEMENT_SPARE = (24, 2.0)  # nodes for later bends: so many, and times those at the start
# Height of an element at the surface: in crests, or in tau L, whichever allows more. Its wet part
# is known, wherever it ends; the load along it is not that of a cubic's nodes.
TALLEST = (4.0, 10.0)
LARGEST_STATIC_MESH = 4000  # nodes beyond which no more are added where it bends
# Contact layers, in units of their own, in turn where a start fails: rows that end with 1. Beyond
# the first row for a line that sinks too deep into the first floor, and folds there.
HARDENING = (1000.0, 100.0, 10.0, 1.0, 100.0, 10.0, 1.0, 30.0, 10.0, 3.0, 1.0)

# Keep quotients finite.
NO_SIZE = 1e-30  # less than any speed, force, stiffness or length that counts
TURNED_BACK = 1e-9  # of a unit vector: what it is across another that it is along, or opposite
NO_DIRECTION = 1e-12  # length of a vector, or sine, that has none

# Round-off, of what is compared.
RELATIVE_ROUNDING = 1e-12  # of times, lengths and motions
SAME_PLACE = 1e-9  # of a length: places along it that differ by less are one
ONE_PLACE = 1e-9  # length by which two places along a line of a system differ that are one [m]
WHOLE = 1e-9  # by what a count may be above a whole number, and still be that
