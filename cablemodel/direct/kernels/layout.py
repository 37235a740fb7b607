"""The direct solver's instance block: its words after those that both solvers share.

    shared header | shared scalars | header | scalars | tables | state || workspace

The first two are those of cablemodel/kernels/layout.py: identity, vessel motion, current, pay-out,
counters and time stand where the shared kernels look for them. Nodes are numbered from the vessel
outwards; a line is a chain of sections, each with nodes of its own, so that the two sides of a
joint are two nodes at one place.
"""

from cablemodel.kernels.layout import HEADER_WORDS, SCALAR_WORDS

MAGIC = 0x5443455249444243  # "CBDIRECT", little endian
VERSION = 3
OWN_WORDS = 64

# Header (int64).
_D = HEADER_WORDS + SCALAR_WORDS
D_SECTIONS, D_SECTION_CAPACITY = _D, _D + 1
D_PLANAR = _D + 2  # 1: four and six unknowns a node in a vertical plane; 0: six and ten
D_METHOD = _D + 3  # linear systems by superposition (0) or elimination (1)
D_JOINT = _D + 4  # joint of the hybrid: 0 as in the paper, 1 moment free
D_END = _D + 5  # what holds the far end, END_...
D_CLAMPED = _D + 6  # bit 0: clamped at the vessel, bit 1: at the anchor
D_FLOOR = _D + 7  # 1 where there is a sea floor
D_RESTART = _D + 8  # 1: the next step is backward Euler, for the rates are not those of the past
D_BODIES, D_DRUM, D_DRUM_USED = _D + 9, _D + 10, _D + 11
D_ITERATIONS_MOST = _D + 12  # most iterations that a step has taken
D_STICKS = _D + 13  # 1 while friction holds the touchdown point
D_MEETING = _D + 14  # slot at which the two sweeps of a superposition meet
D_RIGHT_SIDES = _D + 15  # 1, or 2 where the line ends on the floor
D_TURNED = _D + 16  # how often the frame was turned away from its singularity
D_MATERIALS, D_DRUM_CAPACITY = _D + 17, _D + 18

# Header: word offsets of arrays.
O_SECTION, O_MATERIAL, O_BODY, O_DRUM = _D + 30, _D + 31, _D + 32, _D + 33
O_Y, O_RATE, O_LENGTH, O_FLOW, O_SHARE, O_PLACE = (
    _D + 35,
    _D + 36,
    _D + 37,
    _D + 38,
    _D + 39,
    _D + 40,
)
O_PAST, O_START, O_CURRENTS, O_STRAINS = _D + 41, _D + 42, _D + 43, _D + 44
O_LEFT, O_RIGHT, O_RHS, O_SHAPE = _D + 45, _D + 46, _D + 47, _D + 48
O_SWEEP, O_WORK, O_DELTA, O_OLD_LENGTH = _D + 49, _D + 50, _D + 51, _D + 53

# Scalars (float64).
_X = _D + OWN_WORDS
X_TIME_STEP, X_SPACING, X_ALPHA, X_TOLERANCE = _X, _X + 1, _X + 2, _X + 3
X_BETA = _X + 4  # 1/(alpha dt) of the step that is being made; 0 in a steady state
X_MEMORY = _X + 5  # gamma of eq. 38 in that step
X_DT = _X + 6
X_SHARE = _X + 7  # of the flow (tow speed and current) in a steady state: continuation
X_RATE = _X + 8  # pay-out rate at the end of the step
X_LAID = _X + 9  # cable that lies on the floor behind the touchdown point [m]
X_FLOW_END = _X + 10  # cable that passes the touchdown point [m/s]
X_REACTION = _X + 11  # of the floor on the line's end, normal to the floor [N]
X_VESSEL = _X + 12  # 6 words: tow point, its velocity, in the paper's axes at the end of the step
X_SCALE = _X + 18  # 10 words: size of each unknown
X_FLOOR = _X + 29  # 4 words: unit normal n (paper's axes), and n.x of the plane
X_FRICTION = _X + 33
X_CLAMP = _X + 34  # 4 words: phi, theta of a clamp at the vessel, at the anchor
X_ANCHOR = _X + 38  # 3 words, earth frame
X_DRIFT = _X + 41  # how far a held end may drift [m]
X_FRICTION_FORCE = _X + 42
X_LOWEST = _X + 45  # tension below which a flexible section counts as slack [N]
X_PAID_IN_STEP = _X + 47  # cable paid out within the step [m]
X_START = _X + 48  # 2 words: X_FLOW_END and X_REACTION at the start of the step

FIRST_FREE = _X + OWN_WORDS

# A node's unknowns, the paper's order: velocity of the material and internal force along a1, a2,
# a3; Euler angles; curvatures about a1 and a2.
WIDTH = 10
V1, V2, V3, PHI, THETA, F1, F2, F3, K1, K2 = range(WIDTH)
RATES = 6
"""Words a node of what eq. 38 differentiates in time: velocity, angles, strain."""

# Rows of the section table (int64).
SECTION_WORDS = 10
N_FIRST, N_COUNT, N_KIND, N_MATERIAL, N_BODY = 0, 1, 2, 3, 4
N_POINT = 5  # row of the point body at its start, -1: none
N_HINGE = 6  # 1: the joint at its start is a hinge even between two elasticas
N_ITEM = 7  # which cable of line and drum it belongs to
CABLE, ELASTICA, RIGID = 0, 1, 2

# Rows of the material table.
MATERIAL_WORDS = 12
T_MASS, T_ADDED, T_WEIGHT, T_NORMAL, T_TANGENTIAL, T_BENDING = 0, 1, 2, 3, 4, 5
T_TERMS, T_OFFSET, T_LOW, T_HIGH = 6, 7, 8, 9
T_DISPLACED = 10  # mass of the water that it displaces [kg/m]

# Rows of the body table, with what eq. 38 needs of its past: velocity of the centre of gravity
# (3) and angular velocity (2), then their rates. B_ITEM: its place in line and drum.
BODY_WORDS = 32
B_MASS, B_WEIGHT, B_ADDED, B_ADDED_AXIAL, B_DRAG, B_DRAG_AXIAL = 0, 1, 2, 3, 4, 5
B_HALF, B_OFFSET, B_INERTIA, B_BUOYANCY, B_ITEM = 6, 7, 8, 9, 10
B_STATE, B_STATE_RATE, B_PAST = 11, 16, 21
B_START = 26  # B_STATE at the start of the step
BODY_STATES = 5

# Rows of the drum table (int64 words): what passes the tow point, in order.
DRUM_WORDS = 8
R_MATERIAL, R_KIND, R_POINT, R_ITEM = 0, 1, 2, 3
R_LEAVES = 4  # as float64: pay-out at which its outer end passes the tow point [m]
R_HINGE, R_RIGID = 5, 6

END_FREE, END_ANCHOR, END_CONTACT, END_TOUCHDOWN = 0, 1, 2, 3

BLOCK = WIDTH * WIDTH
SWEEP_WORDS = 220
"""A node's partial solutions: particular (20), complementary (50), T (25), S (10), a and B; or
the rows that elimination keeps of a slot."""
W_PARTICULAR, W_COMPLEMENTARY, W_MIX, W_SHIFT, W_KNOWN, W_CROSS = 0, 20, 70, 95, 105, 115
WORK_WORDS = 800
SHAPE_WORDS = 4
"""Of a slot: rows, unknowns on its left, on its right, and 1 for an interval (int64)."""

RHS_WORDS = 30
"""Of a slot: two right-hand sides and the scales of its rows."""

# Tasks of the entry point `work`.
TASK_STEP, TASK_EQUILIBRIUM, TASK_ASSEMBLE, TASK_SOLVE = 0, 1, 2, 3

SUPERPOSITION, ELIMINATION = 0, 1
PAPER, MOMENT_FREE = 0, 1

# Status codes beyond those of cablemodel/kernels/layout.py.
SLACK, SINGULAR_ANGLE, DRIFT, BODY_ON_FLOOR, SHORT_SECTION = 20, 21, 22, 23, 24
USED_UP, OVERSHOT = 25, 26
