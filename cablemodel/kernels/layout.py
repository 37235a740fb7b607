"""The instance block: one contiguous piece of memory that holds everything of one model.

    header (int64) | scalars | parameters | state | factorisation || workspace

Every array is found through a word offset in the header, never a pointer, so the block can be
copied, saved and mapped by another process. All before the workspace is the *image*: a snapshot,
the FMU's state and its serialisation are a copy of it.
"""

from .record import Record, integer, real, reals, spare

MAGIC = 0x4C45444F4D454C42  # "BLEMODEL", little endian
VERSION = 10

FLOOR_NONE, FLOOR_PLANE, FLOOR_TABLE = 0, 1, 2
FLOOR_FAR, FLOOR_ABOVE, FLOOR_TOUCHED = 0, 1, 2  # nothing of it is felt; the mesh knows; forces


class Header(Record):
    """Identity, sizes and counters of a block, and the words where its arrays start."""

    magic = integer("identity: MAGIC")
    version = integer("VERSION")
    byte_count = integer("bytes of the whole block")
    image_words = integer("words before the workspace")
    capacity = integer("nodes that there is room for")
    nodes = integer("nodes in use")
    dimension = integer("2 in a plane, 3 in space")
    body_count = integer("bodies")
    constraint_count = integer("constraints")
    piece_count = integer("motion pieces, with row 0, the live one")
    depth_count = integer("depths of the table of currents")
    time_count = integer("times of the table of currents")
    strain_words = integer("words of the strain curves' coefficients")
    live = integer("1: the live motion piece (row 0) drives the vessel, 0: the scene's pieces")
    piece = integer("the scene's motion piece that holds the present time")
    current_kind = integer("0: no current, 1: uniform over depth, 2: a table over depth")
    factored = integer("1 while the stored factorisation may be used")
    fresh = integer("1 while that factorisation was made at the present step")
    order = integer("3 or 4: order of the time integrator")
    growth_barred = integer("1 after a rejection: the next step may not grow")
    steps = integer("steps taken")
    rejected = integer("steps rejected")
    factorisations = integer("factorisations made")
    iterations = integer("of Newton's method")
    failed = integer("word (of the workspace) with the node at fault when a step or a start fails")
    maximum_steps = integer("that a call may take, or a relaxation of a static start")
    drag = integer("0 in vacuum: no water terms")
    hybrid = integer("1: elements choose between elastica and cable by their tension")
    floor_kind = integer("FLOOR_NONE, FLOOR_PLANE or FLOOR_TABLE")
    floor_columns = integer("columns of the floor's table, along x")
    floor_rows = integer("rows of the floor's table, along y")
    floor_words = integer("words of the floor's table")

    # Words where arrays start.
    pieces = integer("motion pieces (Piece)")
    depths = integer("depths of the table of currents [m]")
    times = integer("times of the table of currents [s]")
    current = integer("velocities of the table of currents (times, depths, 3) [m/s]")
    strain = integer("coefficients of the strain curves")
    parent = integer("parent of each node, an integer")
    joint = integer("what ties each node to its parent, an integer: JOINT_...")
    edges = integer("edge above each node (Edge)")
    arc = integer("not used")
    bodies = integer("bodies (Body)")
    constraints = integer("constraints (Constraint), and one more for the end that is awake")
    position = integer("places and tangents r, d (nodes, 2, dimension) [m], [-]")
    velocity = integer("their rates (nodes, 2, dimension)")
    acceleration = integer("their second derivatives (nodes, 2, dimension)")
    tension = integer("at both ends of each element (nodes, 2) [N]")
    diagonal = integer("blocks of the factorisation, each (2 dimension, 2 dimension)")
    upper = integer("the same, above the diagonal")
    lower = integer("the same, below the diagonal")
    gradient = integer("of the constraint of each element (nodes, 2, 4, dimension)")
    compliance = integer("inverse of the constraints' compliance (nodes, 3)")
    backup = integer("copy of the image while a step is made")
    stage_velocity = integer("velocities of the stages of a step, four of them")
    stage_acceleration = integer("accelerations of the stages of a step, four of them")
    base_position = integer("positions that a stage starts from")
    base_velocity = integer("velocities that a stage starts from")
    trial_position = integer("positions that are tried")
    trial_velocity = integer("velocities that are tried")
    trial_acceleration = integer("accelerations that are tried")
    trial_tension = integer("tensions that are tried")
    residual = integer("forces out of balance (nodes, 2, dimension) [N]")
    constraint_residual = integer("of each element's two constraints (nodes, 2)")
    increment = integer("of Newton's method (nodes, 2, dimension)")
    profile = integer("current at each depth, now: velocities, then their rates")
    gauss = integer("workspace of an element: GAUSS_WORDS")
    motion = integer("workspace of motions: MOTION_WORDS, then columns for the waves' components")
    tension_rate = integer("rates of the tensions (nodes, 2) [N/s]")
    stage_tension = integer("tensions of the stages of a step")
    stretch = integer("rates of stretch that the tensions ask for (nodes, 2)")

    # Pay-out.
    payout = integer("1 where cable may pass the tow point: the top element's length varies")
    rate_count = integer("rows of the rate table")
    cable_count = integer("rows of the cable table")
    top_cable = integer("row of the cable that passes the tow point")
    rate_live = integer("1: the caller's rate drives, 0: the scene's table")
    clamped = integer("+1: the drum is empty, -1: the shortest length is reached, 0: neither")
    rates = integer("start of the rate table (Rate)")
    cables = integer("start of the cable table (Cable)")
    top = integer("start of the workspace of what passes the tow point")
    end_force = integer("start of internal forces at the ends of each element: parent's, child's")

    rigid = integer("how many of the bodies have a length: 0 skips all that they need")
    wave_count = integer("components of the waves")
    waves = integer("start of their table: columns AMPLITUDE, ... of so many words")

    # Cable at rest on the floor: the nodes at the line's end that sleep.
    sleep = integer("1: cable may sleep (there is friction), 0: it never does")
    asleep = integer("how many nodes sleep")
    left_out = integer("as many while a step is made without them, else 0")
    keep_sleepers = integer("how many of them a step has not yet saved")
    anchor_kept = integer("1 where the row of the far end's constraint waits for them")

    # Two-step scheme.
    has_history = integer("1 while `history` holds the state one step of `last_step` ago")
    two_step_wait = integer("steps to take by the one-step scheme before it is tried again")
    two_step_check = integer("steps until its convergence is measured again")
    history = integer("start of r, d, then their velocities, one step ago (nodes, 2, dimension)")
    keep_matrix = integer("1 while a step has not yet saved the matrix that it may give back")
    two_step_rest = integer(
        "what two_step_wait is set to at a refusal: doubles while it is refused"
    )

    floor = integer("start of x (nx), y (ny), then z, z_x, z_y, z_xy of every place, x slowest")
    rest = integer("start of the places of rest of the friction bristles (nodes, 3) [m]")
    cell_terms = integer("terms of the series in the sea's cells: CELL_TERMS, or 0: no cells")
    _spare_1 = spare(1)
    cell_layers = integer("start of the layers of water that have cells (Layer)")
    cells = integer("start of the cells: three to an element, one to a body, of CELL_WORDS")
    surge = integer("1 while the current changes in time, as of the last set_time")
    settled = integer("1 while the last step left a line that does not ring along itself")
    floor_state = integer("FLOOR_FAR, ...: how near the line is to the floor; 0 also without one")

    # Systems: frames that are driven, free bodies, lines between them. 0 in a scene of one line.
    parts = integer("1: the block is a system's")
    frame_count = integer("frames")
    frame_piece_count = integer("pieces of the frames' motion")
    free_count = integer("free bodies")
    arm_count = integer("ends of lines at points of free bodies")
    foil_count = integer("foils")
    foil_words = integer("words of the foils' tables")
    frames = integer("start of the frames (Frame)")
    frame_pieces = integer("start of the pieces of their motion (Piece)")
    free_bodies = integer("start of the free bodies (FreeBody)")
    arms = integer("start of the arms (Arm)")
    foils = integer("start of the foils (Foil)")
    foil_table = integer("start of their coefficients")
    parts_work = integer("start of a workspace, PARTS_WORDS for each free body")
    _spare_2 = spare(3)


HEADER_WORDS = Header.WORDS


class Scalars(Record, first=HEADER_WORDS):
    """Numbers of a block that there is one of."""

    time = real("present time", "s")
    step = real("next step of the integrator", "s")
    factored_step = real("gamma dt of the stored factorisation", "s")
    tolerance = real("tau, the accuracy that the user asked for")
    time_tolerance = real("local error allowed in a step", "m")
    length = real("of the line", "m")
    smallest_step = real("below which a step fails", "s")
    tension_scale = real("a typical tension", "N")
    origin = reals(3, "origin of the coordinates in the block, earth frame", "m")
    plane = reals(2, "horizontal direction of the plane of a planar model")
    shift = reals(3, "vessel position minus that of the scene's own motion", "m")
    live_current = reals(8, "t0, t1 [s], velocity at t0 (3), at t1 (3)", "m/s")
    gravity = real("gravity", "m/s2")
    water_density = real("density of the water", "kg/m3")
    first_step = real("of a motion that starts", "s")
    last_step = real("length of the last accepted step", "s")

    # Pay-out: travel(t) = travel + rate tau + slope tau^2 / 2, tau = t - time, within one step.
    # Travel is all that has passed the tow point, cable (paid) and bodies of finite length.
    paid = real("cable that has passed the tow point", "m")
    payout_rate = real("rate of pay-out at `time`", "m/s")
    payout_slope = real("and its rate", "m/s2")
    top_length = real("of the top element, or of what is out of a body, at `time`", "m")
    paid_most = real("largest `paid`: the drum is empty", "m")
    paid_least = real("smallest `paid`: the line is at its shortest", "m")
    live_rate = reals(4, "t0, t1 [s], rate at t0, at t1", "m/s")
    stage_rate = real("rate of pay-out at the time of the last set_time", "m/s")
    stage_slope = real("and its rate", "m/s2")
    period = real("sqrt(L/g)", "s")
    axial = real("stiffness of the whole line over its mass", "1/s2")
    undamped = real("1: drag does not damp the line's motion")
    joined = real("longest element that a change of the mesh has joined", "m")
    travel = real("all that has passed the tow point", "m")
    travel_most = real("largest `travel`", "m")
    travel_least = real("smallest `travel`", "m")
    body_passage = real("1 + row of the body of finite length that passes the tow point, 0: none")

    # Sea floor.
    floor_depth = real("delta: the gap below which the floor pushes", "m")
    friction = real("Coulomb coefficient")
    bristle = real("length of a bristle", "m")
    floor_damping = real("force grows by this per speed of approach", "s/m")
    floor_plane = reals(5, "z, slopes towards x and y, place x, y where the height is z")
    floor_top = real("highest point of the floor that can be reached", "m")
    floor_bend = real("a bound on 1/8 of the floor's second derivatives", "1/m")
    floor_wait = real("time since what the floor bears was last looked at", "s")

    # Waves.
    wave_time = real("time of the ramp, as of the last set_time", "s")
    wave_share = real("share of the waves that is up at that time")
    wave_rise = real("rate of that share", "1/s")
    wave_ramp = real("time in which the waves come up", "s")
    wave_step = real("longest step that resolves them", "s")
    wave_depth = real("water depth", "m")
    wave_crest = real("sum of the amplitudes", "m")

    clamp_tension = real("tension at a clamped tow point, smoothed over time", "N")
    stage_top_tension = reals(6, "of the top element, in the stages of the last step", "N")
    largest_tension = real("so far, either way", "N")
    memory = real("how long an error of the velocity moves the line; 0: not looked at", "s")
    wave_x = real("x of the way that the waves go, a horizontal unit vector")
    wave_y = real("y of it")
    halves = real("1: in two halves where the caller's step is shorter than need be")
    laid = real("1: what lies at a start has been laid; 2: and the start's frame moves over it")

    # Cable that sleeps.
    sleep_after = real("time before which no more cable falls asleep", "s")
    sleep_tension = real("at its end", "N")
    sleep_spare = real("what that tension may change by", "N")
    sleep_awake = real("length of cable that lies awake before it", "m")
    sleep_low = real("least height at which it lies", "m")
    sleep_high = real("largest height at which it lies", "m")
    sleep_flow = real("square of the water's speed whose drag is the friction", "m2/s2")

    order_3 = real("steps by order 3 before order 4 is tried again")
    two_step_ratio = real("convergence ratio of Newton in the two-step scheme")
    bent = real("what h^2 times the jump of r'' may be in free water; 0: the mesh stays", "m")
    bent_after = real("time before which the mesh is not looked at again", "s")
    tractable = real("at a floor: longest step that Newton's method is expected to manage", "s")
    most_nodes = real("of what hangs: from there on no bend in the water gets one more")
    end_support = real("what the floor bears for long of the line's end, over its contact")
    _spare = spare(4)
    sleep_push = real("the water's acceleration whose force is the friction", "m/s2")
    current_slope = reals(3, "rate of the live current before t0", "m/s2")
    cell_stays = real("way within which a stage keeps the water of its first iteration", "m")
    stage_time = real("of the last set_time, in a system", "s")


SCALAR_WORDS = Scalars.WORDS

# Rows of the rate table: time, rate. Rows of the cable table: the cables of the line and of the
# drum in the order in which they pass the tow point on the way out.
RATE_WORDS = 2
CABLE_WORDS = 27
K_LEAVES = 0  # travel at which its vessel end passes the tow point [m]
K_NOMINAL = 1  # length of its elements [m]
K_SHORTEST = 2  # length below which its lower end stays on the drum [m]
K_HINGE = 3  # 1: its lower end is a hinge, 0: the slope is shared
K_BODY = 4  # row of the body at its lower end, -1: none
K_DISPLACED = 5  # mass of the water that it displaces [kg/m]
K_EDGE = 6  # a row of the edge table for its elements: EDGE_WORDS

# Rows of the motion table: see cablemodel/scene/motion.py.
PIECE_WORDS = 24
P_START, P_END, P_KIND, P_DATA = 0, 1, 2, 3
P_ACCELERATION_JUMP, P_VELOCITY_JUMP = 22, 23

# Columns of the wave table, one number for each component, in the order of k.
WAVE_WORDS = 6
W_AMPLITUDE, W_FREQUENCY, W_NUMBER = 0, 1, 2  # [m], [rad/s], k [rad/m]
W_PHASE = 3  # at the origin at t = 0
W_SPEED = 4  # amplitude times frequency / (1 - e^-2kh) [m/s]
W_MIRROR = 5  # e^-2kh: the bottom's image

# Series in the cells of a sea, of products of two powers up to a degree. A cell has three, of
# complex numbers, and says what it holds.
CELL_DEGREE = 4
CELL_TERMS = 15
MIRROR_DEGREE = 3  # of the bottom's mirror, which long waves alone feel
MIRROR_TERMS = 10
CELL_WORDS = 8 * CELL_TERMS

# Layers of water, each with cells of its own, larger the deeper they lie: a row of CELL_TERMS
# words, then CELL_TERMS factors of each component. What is not there lies infinitely deep.
CELL_LAYERS = 4
L_DEPTH = 0  # where the layer begins [m]
L_TIME, L_WIDTH = 1, 2  # of a cell [s], along the waves' way and upwards [m]
L_FREQUENCY, L_NUMBER = 3, 4  # of its carrier [rad/s], [rad/m]
L_MIRROR = 5  # 1: the bottom's mirror of the waves is felt

# Rows of the edge table: the element (or joint) that ties a node to its parent.
EDGE_WORDS = 21
E_LENGTH, E_MASS, E_ADDED, E_WEIGHT, E_BENDING = 0, 1, 2, 3, 4
E_DRAG_NORMAL, E_DRAG_TANGENTIAL = 5, 6
E_COMPLIANCE = 7  # c_1 of the strain curve
E_STRAIN_TERMS, E_STRAIN_OFFSET = 8, 9  # number of coefficients, place in the strain table
E_TENSION_LOW, E_TENSION_HIGH = 10, 11  # the curve is continued by its tangent outside
E_STABILISATION = 12
E_BENDING_FULL, E_MODEL, E_TYPE, E_SEGMENT, E_START = 13, 14, 15, 16, 17
E_CONTACT = 18  # weight per length that the floor's preload carries [N/m]
E_NOMINAL = 19  # length up to which elements in free water are joined again [m]
E_BORNE = 20  # what the floor bears for long, in units of E_CONTACT: at least 1
MODEL_ELASTICA, MODEL_CABLE, MODEL_HYBRID = 0, 1, 2

# What ties a node to its parent (`joint`).
JOINT_NONE = 0  # an element
JOINT_HINGE = 1  # the same place, a slope of its own
JOINT_BODY = 2  # a rigid body of finite length, from the parent to the node
JOINT_ARM = 3  # a point of the free body that is the parent: its place follows, its slope is free
JOINT_FREE = 4  # a free body whose reference point is the parent's place; it turns by itself
JOINT_ROOT = 5  # nothing: a tree of its own
JOINT_ROOT_FREE = 6  # nothing: a free body that is a root

# Rows of the body table.
BODY_WORDS = 20
B_NODE, B_MASS, B_WEIGHT, B_ADDED, B_ADDED_AXIAL, B_DRAG, B_DRAG_AXIAL, B_ITEM = range(8)
B_LENGTH = 8  # between its attachments [m]; 0: a point body. Its node is the outer attachment
B_OFFSET = 9  # centre of gravity, in half lengths from the middle
B_INERTIA = 10  # rotary inertia about the centre of gravity [kg m2]
B_DRY_WEIGHT = 11  # weight in air [N]
B_COMPLIANCE = 12  # of its length [m/N]
B_TIE = 13  # at the line's end: stiffness that ties the outer node's slope to its axis [N m]
B_CLAMP = 14  # 2 words: stiffness of the clamps to the cables before and beyond [N m]
B_PULL = 16  # 2 words: tensions there, smoothed over time [N]
B_BORNE = 18  # 2 words: what the floor bears for long at its ends, in units of its weight

# Rows of the constraint table: nodes with a prescribed position or tangent; the vessel's is first.
CONSTRAINT_WORDS = 32
C_NODE, C_KIND, C_POSITION, C_CLAMPED, C_DIRECTION = (
    0,
    1,
    2,
    5,
    6,
)  # 3 words of position, 3 of direction
C_SPRING = 9  # stiffness of a clamp that is a spring [N m]
C_SHARE = 10  # which part of it is no spring but the way of the hinge, see clamp_layer.py
C_PLACE = 11  # 3 words: where that goes to, from the tow point [m]
C_AWAY, C_DRIFT = 14, 17  # 3 words each: how far from there it was [m], and a rate [m/s]
C_LAYER_TIME, C_LAYER_RATE = 20, 21  # when [s]; how fast it goes there [1/s]
C_PULL = 22  # tension by which the layer is as thick as it is [N]
C_DRIFT_RATE = 25  # 3 words: another rate, see `add_layer_motion`
C_PULL_GAIN, C_PULL_CHANGE = 23, 24  # how it follows, and what it was off last [N]
C_FRAME = 28  # row of the frame whose point it is (C_POINT), at C_POSITION in its axes [m]
C_OWN_DIRECTION = 29  # 3 words: a clamp's direction in the frame's axes
C_VESSEL, C_ANCHOR, C_POINT = 1, 2, 3
EXACTLY, BY_SPRING = 1, 2  # how the tangent is held (C_CLAMPED); 0: it is free

# Rows of the frame table: rigid frames that move as prescribed, vessels and driven ends.
FRAME_WORDS = 84
F_POSITION, F_VELOCITY, F_ACCELERATION = 0, 3, 6  # of its origin, earth frame, at the last set_time
F_ROTATION = 9  # 9 words, by rows: its axes in the earth's, columns
F_SPIN, F_SPIN_RATE = 18, 21  # angular velocity [rad/s] and its rate, earth frame
F_LIVE = 24  # 1: the caller's motion drives it, 0: its pieces
F_FIRST, F_COUNT = 25, 26  # pieces of the origin's motion: first row, how many
F_TURN_FIRST, F_TURN_COUNT = 27, 28  # the same of roll, pitch and yaw [rad]; 0: it does not turn
F_SHIFT = 29  # 6 words: position and angles minus those of its own pieces
F_PIECE, F_TURN_PIECE = 36, 60  # live pieces

# Rows of the table of free bodies, axes and places those of the body, from its reference point.
FREE_WORDS = 180
Y_NODE = 0
Y_SIZE = 1  # by which a turn moves what is far out [m]
Y_WEIGHT, Y_BUOYANCY = 2, 3  # in air; of what it displaces [N]
Y_CENTRE, Y_BUOYANCY_CENTRE, Y_DRAG_CENTRE = 4, 7, 10
Y_DRAG = 13  # 3 words: 1/2 rho CdA along its axes [kg/m]
Y_TURN_DRAG = 16  # 3 words: moment per square of the angular velocity about its axes [N m s2]
Y_ORIGIN = 19  # of the body's own axes
Y_SOLID, Y_ADDED = 22, 58  # (6, 6) matrices of inertia, of the body and of the water
Y_ROTATION = 94  # 9 words, by rows: from which the state's rotation vector turns
Y_FORCE = 103  # 14 words: t0, t1, force and torque about the origin then, earth frame
Y_MOTION = 117  # BODY_MOTION words, at the last residual
BODY_MOTION = 33
M_TURN, M_RATES, M_SPIN, M_SPIN_RATE = 0, 9, 18, 21  # axes; Omega = T d(theta)/dt; body axes
M_PLACE, M_SPEED, M_GAIN = 24, 27, 30  # of the reference point
Y_FIRST_FOIL, Y_FOILS = 150, 151
Y_RADIUS = 152  # of a hull that pierces the surface: half of its height [m], 0: none

# Rows of the table of arms.
ARM_WORDS = 8
A_NODE, A_BODY, A_PLACE = 0, 1, 2  # node, row of the body, 3 words in its axes
A_FORCE = 5  # 3 words: what the line pulled with at the last residual [N]

# Rows of the table of foils.
FOIL_WORDS = 20
L_PLACE, L_CHORD, L_SPAN = 0, 3, 6  # chord to the leading edge; span; lift along chord x span
L_AREA = 9  # times half of the water's density [kg/m]
L_TABLE = 10  # word of its table: lift and drag coefficients at FOIL_ANGLES angles
L_DEFLECTION = 11  # 4 words: t0, t1, angle then [rad]
FOIL_ANGLES = 361  # from -180 to 180 degrees

PARTS_WORDS = 160  # of the workspace

# What a line is like as a whole, for scales.measure_line.
FACT_LENGTH = 0  # of its cables [m]
FACT_DAMPING = 1  # rho Cdn d L / m, dimensionless
FACT_SOFTNESS = 2  # of the whole line [m/N]
FACT_MASS = 3  # of cables and bodies, in air [kg]
FACT_TENSION = 4  # a typical one [N]
FACT_SLACK = 5  # 1: it starts without tension
FACT_CALM = 6  # 1: its end is free, there is no floor, no cable runs
FACT_FOLLOWS = 7  # 1: its mesh may change: the scene gives no numbers of elements
FACT_ABOVE_FLOOR = 8
FACT_BENDS = 9  # 1: some of its cables pass a moment
FACT_WORDS = 10
LIGHT_DAMPING = 10.0  # rho Cdn d L / m below which a line counts as hardly damped

# What is read off a state, in words: the rows of outputs.sample_stations, outputs.summarise.
STATION_WORDS, SUMMARY_WORDS, ENERGY_WORDS = 13, 32, 9
FRAME_INPUTS = 13  # words of a frame's input: see entry.drive
# Of a body or frame: place, velocity, acceleration of its origin; axes; angular velocity, its rate.
PART_WORDS = 24

# Elements at a touchdown.
LAYER = 0.4  # smallest element in units of the touchdown layer (EI/w)^(1/3)

# Words of the workspace at `gauss`: those of an element, then the water that it moves through.
ELEMENT_WORDS = 768
GAUSS_WORDS = ELEMENT_WORDS + 24

# Words of the workspace at `motion`; then columns for the components of the waves: four in
# airy.py, and two more in sea_cells.py.
MOTION_WORDS = 80
WATER_COLUMNS = 6

LONGEST_STEP = 1e9  # that a caller may ask for [s]: 30 years; more is a mistake

# Status codes of the kernels.
OK = 0
NOT_CONVERGED, NOT_FINITE, TOO_MANY_STEPS, SINGULAR, STATICS_FAILED = 1, 2, 3, 4, 5
NO_CAPACITY = 6  # the block must grow before this step can be made
STALLED, OVERSTRETCHED = 7, 8
NOTHING, CHANGED = 0, 1  # what a look at the mesh finds, beside NO_CAPACITY

# Strain from which on a step is refused: rubber breaks before; so long a cable comes from an input
# that is a mistake.
LARGEST_STRAIN = 5.0
