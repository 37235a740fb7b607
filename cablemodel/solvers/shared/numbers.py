"""Numbers that steer several parts of the engine, each in one place."""

PROMISE = 10.0  # in tau: what tensions may be wrong by, of the largest one in their line
COMMON_TOLERANCE = 1e-3  # tau at which numbers hold that change with it
FINEST_TOLERANCE = 1e-12  # in its place where one is finer, or none
SHORTEST_LINE = 0.01  # of the initial length: what reel-in leaves out
LYING = 0.2277  # of the contact layer: the gap where a taut cable would touch a rigid floor
OUT_OF_PLANE = 1e-12  # of a horizontal vector: what is across a plane, and still counts as in it
SLOPE_WEIGHT = 0.3  # of an element's length: what a turn of a slope counts as a motion
END_BEND = 0.25  # of what r'' changes by in an element at an end: its jump beside others

# Keep quotients finite.
NO_SIZE = 1e-30  # less than any speed, force, stiffness or length that counts
TURNED_BACK = 1e-9  # of a unit vector: what it is across another that it is along, or opposite
NO_DIRECTION = 1e-12  # length of a vector, or sine, that has none

# Round-off, of what is compared.
RELATIVE_ROUNDING = 1e-12  # of times, lengths and motions
SAME_PLACE = 1e-9  # of a length: places along it that differ by less are one
ONE_PLACE = 1e-9  # length by which two places along a line of a system differ that are one [m]
WHOLE = 1e-9  # by what a count may be above a whole number, and still be that
