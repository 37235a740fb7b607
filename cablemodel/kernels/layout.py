"""The instance block: one contiguous piece of memory that holds everything of one model.

    header (int64) | scalars | parameters | state | factorisation || workspace

Every array is found through a word offset in the header, never a pointer, so the block can be
copied, saved and mapped by another process. All before the workspace is the *image*: a snapshot,
the FMU's state and its serialisation are a copy of it.
"""

MAGIC = 0x4C45444F4D454C42  # "BLEMODEL", little endian
VERSION = 11
HEADER_WORDS = 128
SCALAR_WORDS = 104

# Header: identity, sizes, state counters.
I_MAGIC, I_VERSION, I_BYTES, I_IMAGE_WORDS = 0, 1, 2, 3
I_CAPACITY, I_NODES, I_DIMENSION = 4, 5, 6
I_BODIES, I_CONSTRAINTS, I_PIECES, I_DEPTHS, I_TIMES, I_STRAIN = 7, 8, 9, 10, 11, 12
I_LIVE = 13  # 1: the live motion piece (row 0) drives the vessel, 0: the scene's own pieces
I_PIECE = 14  # the scene's piece that holds the present time
I_CURRENT = 15  # 0 none, 1 uniform over depth, 2 a table over depth
I_SURGE = 100  # 1 while the current changes in time, as of the last set_time
I_FACTORED = 16  # 1 while the stored factorisation may be used
I_FRESH = 17  # 1 while that factorisation was made at the present step
I_ORDER = 18  # 3 or 4: order of the time integrator
I_GROWTH_BARRED = 19  # 1 after a rejection: the next step may not grow
I_STEPS, I_REJECTED, I_FACTORISATIONS, I_ITERATIONS = 20, 21, 22, 23
O_FAILED = 24  # of a word of the workspace: the node at fault when a step or a start fails
I_MAXIMUM_STEPS = 25  # that a call may take, or a relaxation of a static start
I_DRAG = 26  # 0 in vacuum: no water terms
I_HYBRID = 27

# Sea floor.
I_FLOOR, I_FLOOR_X, I_FLOOR_Y = 28, 29, 30  # FLOOR_...; columns and rows of the table
I_FLOOR_WORDS = 31
FLOOR_NONE, FLOOR_PLANE, FLOOR_TABLE = 0, 1, 2
FLOOR_FAR, FLOOR_ABOVE, FLOOR_TOUCHED = 0, 1, 2  # nothing of it is felt; the mesh knows; forces
O_FLOOR = 94  # x (nx), y (ny), then z, z_x, z_y, z_xy of every place, x slowest
O_REST = 95  # places of rest of the friction bristles (capacity, 3)

# Pay-out.
I_PAYOUT = 70  # 1 where cable may pass the tow point: the top element's length varies
I_RATES, I_CABLES = 71, 72  # rows of the rate table and of the cable table
I_TOP_CABLE = 73  # row of the cable that passes the tow point
I_RATE_LIVE = 74  # 1: the caller's rate drives, 0: the scene's table
I_CLAMPED = 75  # +1 the drum is empty, -1 the shortest length is reached, 0 neither
O_RATES, O_CABLES, O_TOP = 76, 77, 78

# Waves.
I_WAVES, O_WAVES = 81, 82  # how many components there are, their rows
I_CELL_TERMS = 96  # of the series in the sea's cells (sea_cells.py): CELL_TERMS, or 0: no cells
O_CELL_LAYERS, O_CELLS = 98, 99  # layers of water, see below; cells of CELL_WORDS each

# Bodies of finite length.
I_RIGID = 80  # how many of the bodies have a length: 0 skips all that they need
# Two-step scheme.
I_HISTORY = 88  # 1 while O_HISTORY holds the state one step of S_LAST_STEP ago
I_TWO_STEP_WAIT = 89  # steps to take by the one-step scheme before it is tried again
I_TWO_STEP_CHECK = 90  # steps until its convergence is measured again
I_TWO_STEP_REST = 93  # what I_TWO_STEP_WAIT is set to at a refusal: doubles while it is refused

I_KEEP_MATRIX = 92  # 1 while a step has not yet saved the matrix that it may have to give back

I_FLOOR_STATE = 102  # FLOOR_FAR, ...: how near the line is to the floor; 0 also without one
I_SETTLED = 101  # 1 while the last step left a line that does not ring along itself

# Cable at rest on the floor: the nodes at the line's end that sleep.
I_SLEEP = 83  # 1: cable may sleep (there is friction), 0: it never does
I_ASLEEP = 84  # how many nodes sleep
I_LEFT_OUT = 85  # as many while a step is made without them, else 0
I_KEEP_SLEEPERS = 86  # how many of them a step has not yet saved
I_ANCHOR_KEPT = 87  # 1 where the row of the far end's constraint waits for them

# Systems: frames that are driven, free bodies, lines between them. 0 in a scene of one line.
I_PARTS = 103
I_FRAMES, I_FRAME_PIECES = 104, 105
I_FREE, I_ARMS = 106, 107  # free bodies; ends of lines at their points
I_FOILS, I_FOIL_WORDS = 108, 109
O_FRAMES, O_FRAME_PIECES, O_FREE, O_ARMS, O_FOILS, O_FOIL_TABLE = 110, 111, 112, 113, 114, 115
O_PARTS_WORK = 116  # PARTS_WORDS of the workspace
I_CUTS, O_CUTS = 117, 118  # places where lines are cut, let go or break
# Of each frame that has them RAO_HEADINGS, and of each of these rows of components.
O_RAOS, I_RAO_WORDS = 119, 120
I_FEET, O_FEET = 121, 122  # places of free bodies that touch the floor

# Header: word offsets of the arrays.
O_PIECES, O_DEPTHS, O_TIMES, O_CURRENT, O_STRAIN = 32, 33, 34, 35, 36
O_PARENT, O_JOINT, O_EDGE, O_ARC, O_BODY, O_CONSTRAINT = 37, 38, 39, 40, 41, 42
O_POSITION, O_VELOCITY, O_ACCELERATION, O_TENSION = 43, 44, 45, 46
O_DIAGONAL, O_UPPER, O_LOWER, O_GRADIENT, O_COMPLIANCE = 47, 48, 49, 50, 51
O_BACKUP, O_STAGE_V, O_STAGE_A, O_BASE_Q, O_BASE_V = 52, 53, 54, 55, 56
O_TRIAL_Q, O_TRIAL_V, O_TRIAL_A, O_TRIAL_T = 57, 58, 59, 60
O_RESIDUAL, O_CONSTRAINT_RESIDUAL, O_INCREMENT = 61, 62, 63
O_PROFILE, O_GAUSS, O_MOTION = 64, 65, 66
O_TENSION_RATE, O_STAGE_T, O_STRETCH = 67, 68, 69
O_HISTORY = 91  # r, d, then their velocities, one step ago: 6 words a node each
O_END_FORCE = 79  # internal force at both ends of each element: parent's end, child's end

# Scalars, at HEADER_WORDS.
_S = HEADER_WORDS
S_TIME, S_STEP, S_FACTORED_STEP = _S, _S + 1, _S + 2
S_TOLERANCE = _S + 3  # tau, the accuracy that the user asked for
S_TIME_TOLERANCE = _S + 4  # local error allowed in a step [m]
S_LENGTH = _S + 5
S_SMALLEST_STEP = _S + 6
S_TENSION_SCALE = _S + 7
S_BASE = _S + 8  # 3 words: origin of the coordinates in the block [m]
S_PLANE = _S + 11  # 2 words: horizontal direction of the plane of a planar model
S_SHIFT = _S + 13  # 3 words: vessel position minus that of the scene's own motion
S_LIVE_CURRENT = _S + 16  # 8 words: t0, t1, velocity at t0 (3), at t1 (3)
S_CURRENT_SLOPE = _S + 99  # 3 words: the live current's rate before that [m/s2]
S_GRAVITY = _S + 24
S_WATER_DENSITY = _S + 25
S_FIRST_STEP = _S + 26
S_LAST_STEP = _S + 27  # length of the last accepted step [s]

# Pay-out: travel(t) = S_TRAVEL + rate tau + slope tau^2 / 2, tau = t - S_TIME, within one step.
# Travel is all that has passed the tow point, cable (S_PAID) and bodies of finite length.
S_PAID, S_PAYOUT_RATE, S_PAYOUT_SLOPE = _S + 28, _S + 29, _S + 30
S_TOP_LENGTH = _S + 31  # length of the top element, or of what is out of a body, at S_TIME [m]
S_PAID_MOST, S_PAID_LEAST = _S + 32, _S + 33
S_LIVE_RATE = _S + 34  # 4 words: t0, t1, rate at t0, at t1
S_CLAMP_PULL = _S + 67  # tension at a clamped tow point, smoothed over time [N]
S_PASSING = _S + 47  # 1 + row of the body of finite length that passes the tow point, 0: none
S_TRAVEL = _S + 44
S_TRAVEL_MOST, S_TRAVEL_LEAST = _S + 45, _S + 46
S_PERIOD = _S + 40  # sqrt(L/g) [s]
S_MEMORY = _S + 75  # how long an error of the velocity moves the line [s]; 0: not looked at
S_AXIAL = _S + 41  # stiffness of the whole line over its mass [1/s2]
S_UNDAMPED = _S + 42  # 1: drag does not damp the line's motion
S_JOINED = _S + 43  # longest element that a change of the mesh has joined [m]
S_FLOOR_DEPTH = _S + 48  # delta: the gap below which the floor pushes [m]
S_FRICTION, S_BRISTLE = _S + 49, _S + 50  # Coulomb coefficient; length of a bristle [m]
S_FLOOR_DAMPING = _S + 51  # force grows by this per speed of approach [s/m]
S_FLOOR_PLANE = _S + 52  # 5 words: z, slopes towards x and y, place x, y where the height is z
S_FLOOR_TOP = _S + 57  # highest point of the floor that can be reached [m]
S_LAID = _S + 79  # 1: what lies at a start has been laid; 2: and the start's frame moves over it
S_FLOOR_WAIT = _S + 59  # time since what the floor bears was last looked at [s]
S_FLOOR_BEND = _S + 58  # a bound on 1/8 of the floor's second derivatives [1/m]
S_WAVE_TIME, S_WAVE_SHARE, S_WAVE_RISE = _S + 60, _S + 61, _S + 62  # ramp at the last set_time
S_WAVE_RAMP = _S + 63  # time in which the waves come up [s]
S_WAVE_STEP = _S + 64  # longest step that resolves them [s]
S_WAVE_DEPTH = _S + 65  # water depth [m]
S_WAVE_CREST = _S + 66  # sum of the amplitudes [m]
S_WAVE_X, S_WAVE_Y = _S + 76, _S + 77  # their way, a horizontal unit vector
S_STAGE_TIME = _S + 103  # of the last set_time, in a system [s]
S_CELL_STAYS = _S + 102  # way within which a stage keeps the water of its first iteration [m]
S_SLEEP_AFTER = _S + 80  # time before which no more cable falls asleep [s]
S_SLEEP_TENSION, S_SLEEP_SPARE = _S + 81, _S + 82  # at its end, what it may change by [N]
S_SLEEP_WAY = _S + 83  # length of cable that lies awake before it [m]
S_SLEEP_LOW, S_SLEEP_HIGH = _S + 84, _S + 85  # heights between which it lies [m]
S_SLEEP_FLOW = _S + 86  # square of the water's speed whose drag is the friction [m2/s2]
S_SLEEP_PUSH = _S + 98  # the water's acceleration whose force is the friction [m/s2]
S_BENT = _S + 89  # what h^2 times the jump of r'' may be in free water [m]; 0: the mesh stays
S_BENT_AFTER = _S + 90  # time before which the mesh is not looked at again [s]
S_TRACTABLE = _S + 91  # at a floor: longest step that Newton's method is expected to manage [s]
S_MOST_NODES = _S + 92  # of what hangs: from there on no bend in the water gets one more
S_END_BORNE = _S + 93  # what the floor bears for long of the line's end, in units of its contact
S_ORDER_3 = _S + 87  # steps by order 3 before order 4 is tried again
S_LARGEST_TENSION = _S + 74  # so far, either way [N]
S_STAGE_TENSION = _S + 68  # 6 words: of the top element, in the stages of the last step [N]
S_HALVES = _S + 78  # 1: in two halves where the caller's step is shorter than need be
S_TWO_STEP_RATIO = _S + 88  # convergence ratio of Newton in the two-step scheme
S_STAGE_RATE, S_STAGE_SLOPE = _S + 38, _S + 39  # at the time of the last set_time

# Rows of the rate table: time, rate. Rows of the cable table: the cables of the line and of the
# drum in the order in which they pass the tow point on the way out.
RATE_WORDS = 2
CABLE_WORDS = 28
K_LEAVES = 0  # travel at which its vessel end passes the tow point [m]
K_NOMINAL = 1  # length of its elements [m]
K_SHORTEST = 2  # length below which its lower end stays on the drum [m]
K_HINGE = 3  # 1: its lower end is a hinge, 0: the slope is shared
K_BODY = 4  # row of the body at its lower end, -1: none
K_DISPLACED = 5  # mass of the water that it displaces [kg/m]
K_LINE = 6  # unstretched length of the line that it is a part of, in a system [m]
K_EDGE = 7  # a row of the edge table for its elements: EDGE_WORDS

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

# What ties a node to its parent (O_JOINT).
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
ALONE = 3  # no line is left at the node

# Rows of the frame table: rigid frames that move as prescribed, vessels and driven ends.
FRAME_WORDS = 122
F_POSITION, F_VELOCITY, F_ACCELERATION = 0, 3, 6  # of its origin, earth frame, at the last set_time
F_ROTATION = 9  # 9 words, by rows: its axes in the earth's, columns
F_SPIN, F_SPIN_RATE = 18, 21  # angular velocity [rad/s] and its rate, earth frame
F_LIVE = 24  # LIVE_...: what drives its place; F_TURN_LIVE: its attitude
F_FIRST, F_COUNT = 25, 26  # pieces of the origin's motion: first row, how many
F_TURN_FIRST, F_TURN_COUNT = 27, 28  # the same of roll, pitch and yaw [rad]; 0: it does not turn
F_SHIFT = 29  # 6 words: position and angles minus those of its own pieces
F_TURN_LIVE = 35
LIVE_NOT, LIVE, LIVE_RETURNS = 0, 1, 2  # its pieces; the caller; a step back to its pieces
F_PIECE, F_TURN_PIECE = 36, 60  # live pieces
F_RAOS = 84  # 1: the waves move it on top of that, by its rows of O_RAOS
F_MEAN = 85  # 18 words: place and angles without the waves' part, with two derivatives each
F_MOVED = 103  # 18 words: the same with it

# Responses of a frame to a wave of 1 m: cosine and sine parts of surge, sway, heave [m], roll,
# pitch, yaw [rad], of each component and heading. A heading is where the waves go to, from the
# frame's x axis.
RAO_WORDS = 12
RAO_HEADINGS = 36  # every 10 degrees from 0

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
Y_RADIUS = 152  # of a ball that displaces as much, where the body has no hull [m]
Y_HULL = 153  # HULL_...: what of it the water can leave
Y_HULL_RADIUS, Y_HULL_HEIGHT = 154, 155  # [m]
Y_HULL_CENTRE = 156  # 3 words
HULL_NONE, HULL_SPHERE, HULL_CYLINDER = 0, 1, 2  # a cylinder about the body's z axis

# Rows of the table of arms.
ARM_WORDS = 8
A_NODE, A_BODY, A_PLACE = 0, 1, 2  # node, row of the body, 3 words in its axes
A_FORCE = 5  # 3 words: what the line pulled with at the last residual [N]

# Rows of the table of feet.
FOOT_WORDS = 8
FOOT_BODY = 0
FOOT_PLACE = 1  # 3 words, from its reference point, in its axes [m]
FOOT_LOAD = 4  # its part of the body's weight [N]
FOOT_REST = 5  # 3 words: where friction holds it, block's coordinates [m]

# Rows of the table of foils.
FOIL_WORDS = 20
L_PLACE, L_CHORD, L_SPAN = 0, 3, 6  # chord to the leading edge; span; lift along chord x span
L_AREA = 9  # times half of the water's density [kg/m]
L_TABLE = 10  # word of its table: lift and drag coefficients at FOIL_ANGLES angles
L_DEFLECTION = 11  # 4 words: t0, t1, angle then [rad]
FOIL_ANGLES = 361  # from -180 to 180 degrees

# Rows of the table of cuts.
CUT_WORDS = 8
CUT_SEGMENT = 0  # row of the cable table whose elements it is in
CUT_ARC = 1  # where, as E_START counts [m]
CUT_SIDE = 2  # CUT_START, CUT_END: at an end of the line, of which these are the first or last
CUT_TIME, CUT_TENSION = 3, 4  # when, and above which tension; infinite: never
CUT_ORDERED = 5  # 1: by the caller
CUT_DONE = 6  # when it was made [s]; infinite: not yet
CUT_WITHIN, CUT_START, CUT_END = 0, 1, 2
NODES_OF_A_CUT = 2  # that it may need

PARTS_WORDS = 160  # of the workspace
FOOT_SCRATCH = 110  # of these: 18 words

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
GIVEN_VELOCITY, GIVEN_POSITION, GIVEN_RATE, GIVEN_ATTITUDE = 1, 2, 4, 8  # bits of its first one
# Of a body or frame: place, velocity, acceleration of its origin; axes; angular velocity, its rate;
# roll, pitch and yaw; force and moment of the lines about a frame's origin.
PART_WORDS = 33

# Elements at a touchdown.
LAYER = 0.4  # smallest element in units of the touchdown layer (EI/w)^(1/3)

# Words of the workspace at O_GAUSS: those of an element, then the water that it moves through.
ELEMENT_WORDS = 768
GAUSS_WORDS = ELEMENT_WORDS + 24

# Words of the workspace at O_MOTION; then columns for the components of the waves: four in
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
