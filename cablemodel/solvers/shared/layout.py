"""The instance block: one contiguous piece of memory that holds everything of one model.

    header (int64) | scalars | parameters | state | factorisation || workspace

Every array is found through a word offset in the header, never a pointer, so the block can be
copied, saved and mapped by another process. All before the workspace is the *image*: a snapshot,
the FMU's state and its serialisation are a copy of it.
"""

from cablemodel.solvers.shared.record import Record, integer, part, real, reals, spare

MAGIC = 0x4C45444F4D454C42  # "BLEMODEL", little endian
VERSION = 30

FLOOR_NONE, FLOOR_PLANE, FLOOR_TABLE = 0, 1, 2
FLOOR_FAR, FLOOR_ABOVE, FLOOR_TOUCHED = 0, 1, 2  # nothing of it is felt; the mesh knows; forces


STAGE_ROWS = 24  # of one word for each node: four stages' velocities, or their accelerations
SPARE_ROWS = 2 * STAGE_ROWS  # both, one behind the other: access.spare_row


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
    growth_barred = integer("steps that may not grow: one after a rejection, more in friction")
    steps = integer("steps taken")
    rejected = integer("steps rejected")
    factorisations = integer("factorisations made")
    iterations = integer("of Newton's method")
    failed = integer("word (of the workspace) with the node at fault when a step or a start fails")
    maximum_steps = integer("that a call may take, or a relaxation of a static start")
    drag = integer("0 in vacuum: no water terms")
    hybrid = integer("1: elements choose between elastica and cable by their tension")
    lays_slack = integer("1: a lay that begins with slack, of cable that is limp then (limp.py)")
    chosen = integer("1: under what pressure elements bend aside has been, since the mesh changed")
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
    tension = integer("of each element (ElementTension) [N]")
    diagonal = integer("blocks of the factorisation, each (2 dimension, 2 dimension)")
    upper = integer("the same, above the diagonal")
    lower = integer("the same, below the diagonal")
    gradient = integer("of the constraint of each element (nodes, 2, 4, dimension)")
    compliance = integer("inverse of the constraints' compliance (InverseCompliance)")
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
    gauss = integer("scratch memory of an element or node (PlanarElement, SpatialElement, ...)")
    motion = integer("of the tow point (Motion), then columns for the waves' components")
    tension_rate = integer("rates of the tensions (ElementTension) [N/s]")
    stage_tension = integer("tensions of the stages of a step")
    stretch = integer("rates of stretch that the tensions ask for (nodes, 2)")
    stage_tensions = integer("tensions in a step's stages, of what is watched (nodes, 6) [N]")

    # Pay-out.
    payout = integer("1 where cable may pass a winch: the length of the element there varies")
    rate_count = integer("rows of the rate tables of all winches")
    cable_count = integer("rows of the cable table")
    winch_count = integer("winches: of one line one, at the tow point")
    winches = integer("start of their table (Winch)")
    rates = integer("start of the rate tables (Rate)")
    cables = integer("start of the cable table (Cable)")
    matter = integer("matter at winches (Matter), then what is out of a body that passes (Body)")
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

    floor = integer("start of x (nx), y (ny), then every place (FloorPlace), x slowest")
    rest = integer("start of rest of the friction bristles: places, slopes (nodes, 2, d) [m, -]")
    cell_terms = integer("terms of the series in the sea's cells: CELL_TERMS, or 0: no cells")
    axial_waves = integer("ends that are held below which waves run along that are followed")
    heard = integer("ends where the last step has heard a ring that no jump began")
    cell_layers = integer("start of the layers of water that have cells (Layer)")
    cells = integer("start of the cells of Gauss points and bodies, of CELL_WORDS")
    surge = integer("1 while the current changes in time, as of the last set_time")
    rings = integer("ends that are held behind which something rings that is followed")
    settled = integer("1 while the last step left a line that does not ring along itself")
    bent_aside = integer("1: some element began or ceased to bend aside in an iteration")
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
    foil_table = integer("start of their tables")
    _spare_3 = spare(1)
    cut_count = integer("places where lines are cut, let go or break")
    cuts = integer("start of them (Cut)")
    raos = integer("start of the responses of each frame that has them: headings, rows for each")
    rao_words = integer("their words")
    foot_count = integer("places of free bodies that touch the floor")
    feet = integer("start of them (Foot)")
    closure_count = integer("ends of lines that close a cycle")
    closures = integer("start of them (Closure)")
    closure_work = integer("start of their columns, and of a dense matrix")

    # For how long lines have been slack (slack.py).
    line_count = integer("lines: 1 where the scene is not a system's")
    lines = integer("start of them (Line)")
    slack = integer("SLACK_UNKNOWN before the first step, SLACK_NOWHERE, SLACK_SOMEWHERE")
    _spare_2 = spare(2)


HEADER_WORDS = Header.WORDS


class VectorRamp(Record):
    """A vector that goes linearly from one value to the next."""

    begin = real("when it begins to", "s")
    end = real("and ends", "s")
    first = reals(3, "until then")
    last = reals(3, "from then on")


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
    live_current = part(VectorRamp, "velocity of the caller's current [m/s]")
    gravity = real("gravity", "m/s2")
    water_density = real("density of the water", "kg/m3")
    first_step = real("of a motion that starts", "s")
    last_step = real("length of the last accepted step", "s")

    period = real("sqrt(L/g)", "s")
    axial = real("stiffness of the whole line over its mass", "1/s2")
    undamped = real("1: drag does not damp the line's motion")
    yields = real("pressure that shortens limp elements to nothing; 0: none is limp", "N")
    joined = real("longest element that a change of the mesh has joined", "m")

    # Sea floor.
    floor_depth = real("delta: the gap below which the floor pushes", "m")
    friction = real("Coulomb coefficient")
    bristle = real("length of a bristle", "m")
    floor_damping = real("force grows by this per speed of approach", "s/m")
    landing_damping = real("so that of bodies", "s/m")
    bristles_damped = real("1: bristles are damped; 0 while an equilibrium is sought")
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
    wave_number = real("k of a wave of their period", "1/m")

    clamp_tension = real("tension at a clamped tow point, smoothed over time", "N")
    largest_tension = real("so far, either way", "N")
    memory = real("how long an error of the velocity moves the line; 0: not looked at", "s")
    wave_x = real("x of the way that the waves go, a horizontal unit vector")
    wave_y = real("y of it")
    halves = real("1: in two halves where the caller's step is shorter than need be")
    laid = real(
        "gap at which none of a start's cable has been laid, in contact layers; 0: all runs"
    )

    # Cable that sleeps.
    sleep_after = real("time before which no more cable falls asleep", "s")
    sleep_tension = real("at its end", "N")
    sleep_spare = real("what that tension may change by", "N")
    sleep_awake = real("length of cable that lies awake before it", "m")
    sleep_way = real("length of the element before it, as it fell asleep", "m")
    sleep_place = reals(3, "where that began", "m")
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
    sleep_push = real("the water's acceleration whose force is the friction", "m/s2")
    current_slope = reals(3, "rate of the live current before t0", "m/s2")
    cell_stays = real("way within which a stage keeps the water of its first iteration", "m")
    stage_time = real("of the last set_time, in a system", "s")

    # The elements' third strain mode (stabilisation.py).
    third_mode = real("its least stiffness", "N")
    stiffened = real("1: some element has more of it, or rests stretched")
    rang = real("1 while something rings, fading within sqrt(L/g); 0: that is forgotten")

    # What makes a line ring along itself (rings.py).
    heard = real("jump of an end's acceleration from which on; 0: none is known", "m/s2")
    heard_most = real("and up to which: more lets the line go slack", "m/s2")
    heard_frequency = real("of the ring", "rad/s")
    modes_known = real("1: ends' first modes, in their rows, are those of the present mesh")


SCALAR_WORDS = Scalars.WORDS


class Edge(Record):
    """The element (or joint) that ties a node to its parent."""

    length = real("without tension", "m")
    mass = real("of the cable, in air", "kg/m")
    added_mass = real("across the cable", "kg/m")
    weight = real("in water", "N/m")
    bending = real("stiffness in use: 0 while the element is a cable", "N m2")
    drag_normal = real("1/2 rho Cdn d", "kg/m2")
    drag_tangential = real("1/2 rho Cdt pi d", "kg/m2")
    compliance = real("c_1 of the strain curve", "1/N")
    damping = real("in use: mean force over the mean rate of strain", "N s")
    damping_01 = real("in use: a mode of force over the other mode of the rate of strain", "N s")
    damping_11 = real("in use: force along P1 over the moment of the rate of strain", "N s")
    damping_full = real("of the cable; less is in use where flexible cable goes slack", "N s")
    strain_terms = real("number of coefficients of the strain curve")
    strain_offset = real("their place in the table of strain curves")
    tension_low = real("below which the curve is continued by its tangent", "N")
    tension_high = real("above which it is", "N")
    stabilisation = real("stiffness of the third strain mode (stabilisation.py)", "N")
    third_rest = real("what that takes off the mode's tension: its strain at rest", "N")
    stretch_rest = real("by what it is longer without tension (stretch.py)", "m")
    moment_rest = real("integral of that strain times P1", "m")
    flexible = real("1: cable without bending stiffness; LAID_SLACK: of a lay in a system")
    bears = real("pressure that it bears before it bends aside within the element", "N")
    yields = real("stiffness beyond; 0: it never does", "N")
    pulled = real("1: something pulls it taut, at both ends or beyond")
    bending_full = real("bending stiffness of the cable", "N m2")
    model = real("MODEL_ELASTICA, MODEL_CABLE or MODEL_HYBRID")
    type = real("of the cable: row of the scene's types")
    segment = real("which cable of line and drum it belongs to: a row of the cable table")
    start = real("length of its cable before it", "m")
    contact = real("weight per length that the floor's preload carries", "N/m")
    nominal = real("length up to which elements in free water are joined again", "m")
    support = real("what the floor bears for long, over `contact`: at least 1")


EDGE_WORDS = Edge.WORDS
LAID_SLACK = 2  # `flexible`
MODEL_ELASTICA, MODEL_CABLE, MODEL_HYBRID = 0, 1, 2

# What ties a node to its parent (`joint`).
JOINT_NONE = 0  # an element
JOINT_HINGE = 1  # the same place, a slope of its own
JOINT_BODY = 2  # a rigid body of finite length, from the parent to the node
JOINT_ARM = 3  # a point of the free body that is the parent: its place follows, its slope is free
JOINT_FREE = 4  # a free body whose reference point is the parent's place; it turns by itself
JOINT_ROOT = 5  # nothing: a tree of its own
JOINT_ROOT_FREE = 6  # nothing: a free body that is a root


class ElementTension(Record):
    """Tension in an element, or its rate: mean + slope P1, P1 from -1 to 1 along it."""

    mean = real("of the element", "N")
    slope = real("how much more it is at its end than in its middle", "N")


TENSION_WORDS = ElementTension.WORDS


class InverseCompliance(Record):
    """Tensions by what an element's two constraints miss."""

    s00 = real("the mean by the mean", "N/m")
    s01 = real("the mean by the moment, and the slope by the mean", "N/m")
    s11 = real("the slope by the moment", "N/m")


COMPLIANCE_WORDS = InverseCompliance.WORDS


class FloorPlace(Record):
    """The floor at a place of its table."""

    z = real("height", "m")
    by_x = real("its slope along x")
    by_y = real("its slope along y")
    by_xy = real("its second derivative by both", "1/m")


FLOOR_PLACE_WORDS = FloorPlace.WORDS


class Ramp(Record):
    """A number that goes linearly from one value to the next."""

    begin = real("when it begins to", "s")
    end = real("and ends", "s")
    first = real("until then")
    last = real("from then on")


class Winch(Record):
    """What pays a line out and takes it in, at a node that is held.

    travel(t) = travel + rate tau + slope tau^2 / 2, tau = t - time, within one step. Travel is all
    that has passed it, cable (paid) and bodies of finite length. The element next to the node is
    the top one.
    """

    node = real("where it is; -1: its line has been cut off")
    way = real("+1: the tree goes on from there, -1: it comes to there")
    start = real("what edges' `start` counts at the node when no cable has passed", "m")
    travel = real("all that has passed", "m")
    travel_most = real("largest `travel`", "m")
    travel_least = real("smallest `travel`", "m")
    paid = real("cable that has passed", "m")
    paid_most = real("largest `paid`: the drum is empty", "m")
    paid_least = real("smallest `paid`: the line is at its shortest", "m")
    rate = real("of travel at `time`", "m/s")
    slope = real("rate of that", "m/s2")
    acceleration_jump = real("by how much that has jumped as the last step began", "m/s2")
    stage_rate = real("rate at the time of the last set_time", "m/s")
    stage_slope = real("rate of that", "m/s2")
    top_length = real("of the top element, or of what is out of a body, at `time`", "m")
    passing_body = real("1 + row of the body of finite length that passes, 0: none")
    cable = real("row of the cable that passes")
    off_drum = real("+1 or -1: from a cable's row to that of the next one off the drum")
    shortest = real("length that reeling in leaves of what may pass", "m")
    at_limit = real("+1: the drum is empty, -1: the shortest length is reached, 0: neither")
    live = real("LIVE_NOT, LIVE or LIVE_RETURNS: what drives it")
    live_rate = part(Ramp, "the caller's rate [m/s]")
    first_rate = real("its rows of the rate table: the first one")
    rates = real("how many")


WINCH_WORDS = Winch.WORDS
OFF_THE_DRUM, ALONG_THE_LINE = 1, -1  # where the next cable is


class Matter(Record):
    """The cable at a winch's node: what the nodes' rates would be if nodes moved with it."""

    velocity = reals(6, "of place and slope, (2, dimension)", "m/s")
    acceleration = reals(6, "of both, (2, dimension)", "m/s2")


MATTER_WORDS = Matter.WORDS


class Rate(Record):
    """A row of the rate table."""

    time = real("from which the rate goes on linearly to the next row's", "s")
    rate = real("of pay-out then", "m/s")


RATE_WORDS = Rate.WORDS


class Cable(Record):
    """A cable of a line or of a drum, in the order in which they pass the tow point."""

    chain = real("of the cables that follow on each other past a winch; all of a line of one")
    leaves = real("where the joint to the row after it is, by the winch's travel or `start`", "m")
    nominal = real("length of its elements", "m")
    shortest = real("length of it that is out before the joint after it leaves the drum", "m")
    hinge = real("1: the joint to the row before it is a hinge, 0: the slope is shared")
    body = real("row of the body there, -1: none")
    displaced = real("mass of the water that it displaces", "kg/m")
    line = real("unstretched length of the line that it is a part of, in a system", "m")
    tension = real("largest so far in it, in a system; at least that line's weight", "N")
    row = real("of that line in the table of lines")
    backward = real("1: the tree goes along it from that line's end to its beginning")
    counted = real("1: the scene counts its elements, which a start leaves as they are")
    edge = part(Edge, "of its elements")


CABLE_WORDS = Cable.WORDS


class Line(Record):
    """A line, and for how long and where some of it has been slack (slack.py)."""

    threshold = real("lowest tension above which it is taut again", "N")
    winch = real("row of the winch at its beginning, -1: none")
    slack = real("1: a spell of that goes on")
    total = real("how long all of them have lasted so far", "s")
    longest = real("the longest one so far", "s")
    since = real("when the last one began; not a number: none has", "s")
    first = real("arc length where what has been without tension begins, or not a number", "m")
    last = real("where it ends", "m")
    before = real("lowest tension at the start of a step", "N")
    rate = real("of that tension there", "N/s")
    after = real("at its end", "N")


LINE_WORDS = Line.WORDS
SLACK_UNKNOWN, SLACK_NOWHERE, SLACK_SOMEWHERE = 0, 1, 2


class Body(Record):
    """A body of the line or of the drum."""

    node = real("its node; of one with a length the outer attachment; negative on the drum")
    mass = real("in air", "kg")
    weight = real("in water", "N")
    added_mass = real("across its axis", "kg")
    added_mass_axial = real("along its axis", "kg")
    drag = real("1/2 rho CdA across its axis", "kg/m")
    drag_axial = real("1/2 rho CdA along its axis", "kg/m")
    item = real("its place in line and drum")
    length = real("between its attachments; 0: a point body", "m")
    offset = real("of the centre of gravity from the middle, in half lengths")
    inertia = real("rotary, about the centre of gravity", "kg m2")
    dry_weight = real("weight in air", "N")
    compliance = real("of its length", "m/N")
    tie = real("at the line's end: stiffness that ties the outer node's slope to its axis", "N m")
    clamp = reals(2, "stiffness of the clamps to the cables before and beyond", "N m")
    clamp_tension = reals(2, "tensions there, smoothed over time", "N")
    support = reals(2, "what the floor bears for long at its ends, over its weight")


BODY_WORDS = Body.WORDS


class Motion(Record):
    """Of a point, or of roll, pitch and yaw [rad]. In the block's coordinates of a planar model two
    of three count."""

    position = reals(3, "where it is", "m")
    velocity = reals(3, "its rate", "m/s")
    acceleration = reals(3, "the rate of that", "m/s2")


class Constraint(Record):
    """A node with a prescribed position or tangent; the vessel's is the first."""

    node = real("that is held")
    kind = real("HELD_BY_VESSEL, HELD_BY_ANCHOR or HELD_BY_FRAME")
    position = reals(3, "of the anchor; of a frame's point: in the frame's axes", "m")
    clamped = real("EXACTLY, BY_SPRING, WHOLLY, or 0: the tangent is free")
    direction = reals(3, "of the clamp")
    spring = real("stiffness of a clamp that is a spring", "N m")
    share = real("part of it that is no spring but the way of the hinge (clamp_layer.py)")
    place = reals(3, "where that goes to, from the tow point", "m")
    away = reals(3, "how far from there it was", "m")
    drift = reals(3, "a rate of that", "m/s")
    layer_time = real("when", "s")
    layer_rate = real("how fast it goes there", "1/s")
    layer_tension = real("by which the layer is as thick as it is", "N")
    tension_gain = real("how that follows the tension")
    tension_change = real("what it was off last", "N")
    drift_rate = reals(3, "another rate (`add_layer_motion`)", "m/s")
    frame = real("row of the frame whose point it is")
    own_direction = reals(3, "a clamp's direction in the frame's axes")
    ring = real("tension that rings there since an acceleration jumped, 0: none is followed", "N")
    ring_frequency = real("of that", "rad/s")
    ring_lasts = real("until it has died away", "rad")
    ring_since = real("when the window began in which it is measured", "s")
    ring_about = real("tension when that window began", "N")
    ring_cosine = real("the window's integral so far: of the ring's cosine", "N")
    ring_sine = real("of its sine", "N")
    ring_share = real("what it may be missed by, over what the line next to it allows")
    ring_missed = real("what the last step has missed of one that no jump began", "N")
    wave = real("tension of the first wave that runs along since then, 0: none is followed", "N")
    wave_frequency = real("of that", "rad/s")
    wave_began = real("when the last jump made waves", "s")
    wave_since = real("when the window began in which it is measured", "s")
    wave_seen = real("the largest in that window", "N")
    wave_lasts = real("until it has died away, 0: not measured yet", "rad")
    wave_element = real("the longest that an element may be, as the time of sound", "s")
    mode_frequency = real("of the first motion along itself of what hangs there", "rad/s")
    mode_mass = real("that moves with it when the node accelerates", "kg")
    bow = real("1: that motion is across, of a line that hangs in a bow")


CONSTRAINT_WORDS = Constraint.WORDS
HELD_BY_VESSEL, HELD_BY_ANCHOR, HELD_BY_FRAME = 1, 2, 3
EXACTLY, BY_SPRING = 1, 2  # how the tangent is held
WHOLLY = 3  # its length too: cable beyond sleeps, or no line is left at the node


class Polynomial(Record):
    """The law of a piece of motion: a polynomial of the time since its piece began."""

    position = reals(3, "at the beginning", "m")
    velocity = reals(3, "there", "m/s")
    second = reals(3, "coefficients of the second power", "m/s2")
    third = reals(3, "of the third", "m/s3")
    fourth = reals(3, "of the fourth", "m/s4")


class ArcLaw(Record):
    """The law of a piece of motion along a level circle."""

    centre = reals(3, "of it", "m")
    radius = real("of it", "m")
    angle = real("from the x axis where the piece begins", "rad")
    rate = real("of that angle there", "rad/s")
    spin = real("rate of that", "rad/s2")


class Piece(Record):
    """A piece of the vessel's motion: see cablemodel/scene/motion.py."""

    start = real("from which time on it holds", "s")
    end = real("until which time", "s")
    kind = real("of its law: POLYNOMIAL or ARC")
    data = reals(18, "that law: a Polynomial or an ArcLaw")
    jerk_jump = real("at its start", "m/s3")
    acceleration_jump = real("at its start", "m/s2")
    velocity_jump = real("at its start", "m/s")


PIECE_WORDS = Piece.WORDS
POLYNOMIAL, ARC = 0, 1


class Frame(Record):
    """A rigid frame that moves as prescribed, a vessel or a driven end, at the last set_time."""

    motion = part(Motion, "of its origin, earth frame")
    rotation = reals(9, "by rows: its axes in the earth's, columns")
    spin = reals(3, "angular velocity, earth frame", "rad/s")
    spin_rate = reals(3, "its rate", "rad/s2")
    live = real("LIVE_NOT, LIVE or LIVE_RETURNS: what drives its place")
    first = real("pieces of the origin's motion: first row")
    count = real("how many")
    turn_first = real("the same of roll, pitch and yaw")
    turn_count = real("how many; 0: it does not turn")
    shift = reals(6, "position and angles minus those of its own pieces")
    turn_live = real("what drives its attitude")
    piece = part(Piece, "live piece of the origin")
    turn_piece = part(Piece, "live piece of the angles")
    raos = real("the waves move it on top of that: 1 + the word of its headings in `raos`; or 0")
    headings = real("how many, in [0, 2 pi) and in order")
    mean = part(Motion, "of its origin without the waves' part")
    mean_angles = part(Motion, "of its angles without it")
    moved = part(Motion, "of its origin with it")
    moved_angles = part(Motion, "of its angles with it")
    _spare = spare(1)


FRAME_WORDS = Frame.WORDS
LIVE_NOT, LIVE, LIVE_RETURNS = 0, 1, 2  # the scene; the caller; a step back to the scene


# Responses of a frame to a wave of 1 m: cosine and sine parts of surge, sway, heave [m], roll,
# pitch, yaw [rad], of each component and heading. A heading is where the waves go to, from the
# frame's x axis.
class WaveResponse(Record):
    """Of a frame in one of its six freedoms, to a wave of 1 m."""

    even = real("with the cosine of the wave's phase", "m or rad")
    odd = real("with its sine", "m or rad")


RESPONSE_WORDS = WaveResponse.WORDS
RAO_WORDS = 6 * RESPONSE_WORDS


class WrenchRamp(Record):
    """A force and a moment that go linearly from one value to the next."""

    begin = real("when they begin to", "s")
    end = real("and end", "s")
    first = reals(6, "until then")
    last = reals(6, "from then on")


class BodyMotion(Record):
    """Motion of a free body at the last residual."""

    turn = reals(9, "its axes, by rows")
    rates = reals(9, "T by rows, where Omega = T d(theta)/dt")
    spin = reals(3, "angular velocity, body's axes", "rad/s")
    spin_rate = reals(3, "its rate, body's axes", "rad/s2")
    reference = part(Motion, "of the reference point, earth frame")


class FreeBody(Record):
    """A body that moves freely; axes and places are its own, from its reference point."""

    node = real("its node")
    size = real("by which a turn moves what is far out", "m")
    weight = real("in air", "N")
    buoyancy = real("weight of what it displaces", "N")
    centre = reals(3, "of gravity", "m")
    buoyancy_centre = reals(3, "of what it displaces", "m")
    drag_centre = reals(3, "where drag attacks", "m")
    drag = reals(3, "1/2 rho CdA along its axes", "kg/m")
    turn_drag = reals(3, "moment per square of the angular velocity about its axes", "N m s2")
    origin = reals(3, "of the axes that the scene gives it", "m")
    solid = reals(36, "(6, 6) matrix of inertia of the body")
    added = reals(36, "(6, 6) matrix of inertia of the water")
    rotation = reals(9, "by rows: from which the state's rotation vector turns")
    force = part(WrenchRamp, "of the caller, about the origin, earth frame [N, N m]")
    motion = part(BodyMotion, "at the last residual")
    first_foil = real("row of its first foil")
    foil_count = real("how many foils it has")
    radius = real("of a ball that displaces as much, where the body has no hull", "m")
    hull = real("HULL_...: what of it the water can leave")
    hull_radius = real("of that", "m")
    hull_height = real("of that", "m")
    hull_centre = reals(3, "its middle", "m")
    _spare = spare(21)


FREE_WORDS = FreeBody.WORDS
BODY_CELLS = 3  # of a sea, that a free body keeps: of its middle, and towards both ends
HULL_NONE, HULL_SPHERE, HULL_CYLINDER = 0, 1, 2  # a cylinder about the body's z axis


class Arm(Record):
    """An end of a line at a point of a free body."""

    node = real("of the line")
    body = real("row of the body")
    place = reals(3, "in the body's axes", "m")
    force = reals(3, "what the line pulled with at the last residual", "N")
    kept = reals(3, "that of the last accepted state", "N")


ARM_WORDS = Arm.WORDS


class Closure(Record):
    """An end of a line at a point of a free body, or at a node, that is in the tree before it; or
    the clamp of an end at a free body (body_clamps.py), which has a direction for a place."""

    node = real("of the line; -1: it is cut off")
    body = real("row of the body; -1: a node")
    other = real("that node")
    place = reals(3, "in the body's axes", "m")
    force = reals(3, "that holds the line's end", "N")
    kept = reals(3, "that of the last accepted state", "N")
    change = reals(3, "by the last increment", "N")
    gap = reals(3, "of both places, or rate of it", "m")
    follows = reals(9, "how the place follows the body's rotation vector", "m")
    clamp = real("1: it is a clamp")
    stiffness = real("of that", "N m")
    tension = real("of its line there, smoothed over time", "N")
    slopes = reals(9, "how the slope's direction follows the slope")


CLOSURE_WORDS = Closure.WORDS


class Foil(Record):
    """A foil of a free body."""

    place = reals(3, "of it, body's axes", "m")
    chord = reals(3, "towards the leading edge")
    span = reals(3, "along it; lift along chord x span")
    area = real("times half of the water's density", "kg/m")
    table = real("word of its first FoilRow in `foil_table`")
    rows = real("how many there are, from -180 to 180 degrees")
    deflection = part(Ramp, "as the caller turns it [rad]")
    reach = real("half of the side of a square of its area: the band in which it becomes wet", "m")
    _spare = spare(3)


FOIL_WORDS = Foil.WORDS


class FoilRow(Record):
    """Coefficients of a foil at an angle; cubic between rows."""

    angle = real("of attack", "rad")
    lift = real("coefficient")
    lift_slope = real("its derivative", "1/rad")
    drag = real("coefficient")
    drag_slope = real("its derivative", "1/rad")


FOIL_ROW_WORDS = FoilRow.WORDS


class Cut(Record):
    """A place where a line of a system is cut, let go or breaks."""

    segment = real("row of the cable table whose elements it is in")
    arc = real("where, as the edges' `start` counts", "m")
    side = real("CUT_WITHIN, or CUT_START, CUT_END: at an end of the line")
    time = real("when; infinite: never", "s")
    tension = real("above which; infinite: never", "N")
    ordered = real("1: by the caller")
    done = real("when it was made; infinite: not yet", "s")
    _spare = spare(1)


CUT_WORDS = Cut.WORDS
CUT_WITHIN, CUT_START, CUT_END = 0, 1, 2
NODES_OF_A_CUT = 2  # that it may need


class Foot(Record):
    """A place of a free body that touches the floor."""

    body = real("row of the body")
    place = reals(3, "from its reference point, in its axes", "m")
    load = real("its part of the body's weight", "N")
    rest = reals(3, "where friction holds it, block's coordinates", "m")
    friction = real("Coulomb coefficient: the floor's, once the start is found")
    pressed = real("what it bore at the last step over its load, at least 1: so stiff is friction")


FOOT_WORDS = Foot.WORDS

# Columns of the wave table, one number for each component, in the order of k.
WAVE_WORDS = 6
W_AMPLITUDE, W_FREQUENCY, W_NUMBER = 0, 1, 2  # [m], [rad/s], k [rad/m]
W_PHASE = 3  # at the origin at t = 0
W_SPEED = 4  # amplitude times frequency / (1 - e^-2kh) [m/s]
W_MIRROR = 5  # e^-2kh: the bottom's image

# Series in the cells of a sea, of products of two powers up to a degree.
CELL_DEGREE = 4
CELL_TERMS = 15
MIRROR_DEGREE = 3  # of the bottom's mirror, which long waves alone feel
MIRROR_TERMS = 10
CELL_LAYERS = 4  # of water


class Cell(Record):
    """The last cell of a sea that a Gauss point or a body asked for (sea_cells.py).

    Terms x^q t^p of a series, each a real and an imaginary part, are in the order of q + p, then of
    q: a lower degree is what comes first.
    """

    rising = reals(2 * CELL_TERMS, "series of the waves", "m/s")
    surface = reals(2 * CELL_TERMS, "series of the elevation", "m")
    mirror = reals(2 * CELL_TERMS, "series of the bottom's mirror", "m/s")
    held = real("which of them: HOLDS_NOTHING, HOLDS_WATER or HOLDS_ALL")
    t = real("which cell it is: its number in time")
    x = real("along the waves' way")
    z = real("and upwards")
    alive = real("components that have not died out there")
    layer = real("first word of its layer of water")
    stage = real("that has found what follows; of the first slot, which has no point: the last one")
    way = real("where: along the waves' way", "m")
    level = real("and upwards", "m")
    elevation = real("of the surface there", "m")
    velocity = reals(3, "of the water there", "m/s")
    acceleration = reals(3, "of the water there", "m/s2")
    within = real("of the first slot, 1: a stage is under way")
    _spare = spare(2 * CELL_TERMS - 17)


CELL_WORDS = Cell.WORDS  # a multiple of CELL_TERMS
HOLDS_NOTHING, HOLDS_WATER, HOLDS_ALL = 0, 1, 2  # without the surface; with it


class Layer(Record):
    """A layer of water with cells of its own, larger the deeper they lie.

    Then come CELL_TERMS factors of each component. What is not there lies infinitely deep.
    """

    depth = real("where the layer begins", "m")
    time = real("of a cell", "s")
    width = real("of a cell, along the waves' way and upwards", "m")
    frequency = real("of its carrier", "rad/s")
    number = real("of its carrier", "rad/m")
    mirror = real("1: the bottom's mirror of the waves is felt")
    _spare = spare(9)


class CableLength(Record):
    """A cable of a line, or on a drum, and the length that it gets before a start: lengths.py.

    Rows are in the order of each line's cables, from its beginning; then as they leave each drum.
    """

    row = real("of it in the cable table")
    line = real("number of its line")
    winch = real("number of the winch on whose drum it is; -1: it is out")
    first = real("its length in the scene", "m")
    before = real("its length so far", "m")
    length = real("its length from now on", "m")
    softness = real("c_1 of its strain curve", "1/N")
    mass = real("in air", "kg/m")
    drag = real("rho Cdn d", "kg/m2")
    tension = real("what it adds to a typical tension", "N/m")
    counted = real("1: the scene counts its elements")


LENGTH_WORDS = CableLength.WORDS


class LineFacts(Record):
    """What a line is like as a whole, or the lines of a system, for scales.measure_line."""

    length = real("of its cables; of a system of the longest line", "m")
    shortest = real("the same of the shortest line", "m")
    damping = real("rho Cdn d L / m, of the line where it is least")
    softness = real("of the whole line, of the softest one", "m/N")
    mass = real("of cables and bodies, in air", "kg")
    tension = real("a typical one", "N")
    memory = real("how many times as long as a cable's motion that of a body goes on")
    slack = real("1: it starts without tension")
    calm = real("1: its end is free, there is no floor, no cable runs")
    follows = real("1: its mesh may change: the scene gives no numbers of elements")
    above_floor = real("1: there is a floor")
    bends = real("1: some of its cables pass a moment")


FACT_WORDS = LineFacts.WORDS
LIGHT_DAMPING = 10.0  # rho Cdn d L / m below which a line counts as hardly damped


class Summary(Record):
    """What is read off a state at every output (outputs.summarise); vectors in the earth frame."""

    wrench = reals(6, "force [N] and moment [N m] of the cable on the vessel")
    top_tension = real("size of that force, negative where the cable pushes", "N")
    tension_min = real("lowest in the cable", "N")
    tension_max = real("highest in it, and at the top", "N")
    tip_position = reals(3, "the line's far end, the outer one of a body there", "m")
    tip_velocity = reals(3, "its velocity", "m/s")
    vessel_position = reals(3, "the tow point", "m")
    vessel_velocity = reals(3, "its velocity", "m/s")
    line_length = real("unstretched cable that is out", "m")
    payout_rate = real("as it is applied", "m/s")
    drum_length = real("cable on the drum", "m")
    floor_force = reals(3, "of the floor on the cable", "N")
    floor_length = real("on the floor", "m")
    touchdown_position = reals(3, "touchdown point; not a number: none", "m")
    touchdown_reaction = real("concentrated there", "N")
    slack_time = real("for how long some of the line has been slack so far", "s")
    slack_longest = real("the longest spell of that", "s")
    slack_since = real("when the last one began; not a number: none has", "s")
    slack_start = real("arc length where what has been slack so far begins, or not a number", "m")
    slack_end = real("where it ends", "m")


SUMMARY_WORDS = Summary.WORDS


class Station(Record):
    """The state at a place of a cable; of a body its centre's place, its axis and velocity."""

    position = reals(3, "in the earth frame", "m")
    tangent = reals(3, "along the cable, a unit vector")
    velocity = reals(3, "of the material", "m/s")
    tension = real("effective", "N")
    curvature = real("of the centre line", "1/m")
    bending_moment = real("there", "N m")
    on_floor = real("1: the floor bears it")


STATION_WORDS = Station.WORDS


class Energies(Record):
    """Energies and powers of a state: see outputs.energies."""

    kinetic = real("with added mass; in waves without", "J")
    axial = real("of the axial strain", "J")
    bending = real("of the curvature and of clamps", "J")
    potential = real("of the submerged weight, zero at z = 0; in waves of the weight in air", "J")
    vessel_power = real("of the supports on the cable", "W")
    damping_power = real("lost in the cable's material", "W")
    drag_power = real("lost to drag; in waves what the water takes by all its forces", "W")
    floor = real("what the floor's springs hold", "J")
    floor_power = real("lost to friction and damping on the floor", "W")
    added_mass_power = real("that added mass takes beyond its share of the kinetic energy", "W")


ENERGY_WORDS = Energies.WORDS


class StepInputs(Record):
    """What a caller gives of a line for the end of a step; what is not given follows the scene."""

    velocity_given = real("1: the tow point's velocity is given")
    velocity = reals(3, "of it", "m/s")
    position_given = real("1: its position is given")
    position = reals(3, "of it", "m")
    current_given = real("1: a current is given, besides the scene's")
    current = reals(3, "velocity of that", "m/s")
    payout_given = real("1: the rate of pay-out is given")
    payout_rate = real("that rate", "m/s")


INPUT_WORDS = StepInputs.WORDS


class StartMove(Record):
    """Where a tow point begins that is not where the scene has it: resizing.move_start."""

    way = reals(3, "from where the scene has it", "m")
    position = reals(3, "where it begins, earth frame", "m")
    velocity = reals(3, "how fast", "m/s")
    driven = real("1: it goes on at that velocity")


START_MOVE_WORDS = StartMove.WORDS


class FirmHold(Record):
    """How friction takes hold of what lies to anchors, at a start: firm_friction.go_on_holding."""

    own = real("length of bristles on which the start was found", "m")
    least = real("as short as tensions ask", "m")
    for_steps = real("that steps go on with", "m")
    length = real("at which an equilibrium is sought; 0: at none yet", "m")
    drawn = real("times that roots were drawn after what slips, at that length")
    is_last = real("1: what is found next is the start")


FIRM_HOLD_WORDS = FirmHold.WORDS


class Settling(Record):
    """How a system comes to rest from where its nodes are: settling.go_on_settling."""

    begun = real("1: it has been")
    begins = real("1: the equilibrium that is to be found next is the first on its elements")
    stage = real("0: on the elements that it has; AT_BENDS, AT_FLOOR: those that are shortened")
    rounds = real("times that elements were halved at that stage")
    way = real("0: at once, 1 and more: on floors that harden, those of a row")
    floor = real("which of them")
    depth = real("of the contact layer", "m")
    friction = real("of the floor, which a start is sought without")
    stabilised = real("1: with the elements' stabilisation of what was found")


SETTLING_WORDS = Settling.WORDS
AT_BENDS, AT_FLOOR, SETTLED = 1, 2, 3  # stages


class FirstShape(Record):
    """Where the parts of a system are at first: strings of masses (kernels/start/strings.py).

    Behind it: rows of its lines, of what each of them is made of, of bodies, of both ends of each
    line; three random numbers, the arc length and the place of each mass.
    """

    lines = real("how many there are")
    items = real("cables and point bodies of all lines, in the order of each")
    bodies = real("free bodies")
    most = real("masses that there is room for")
    gravity = real("acceleration", "m/s2")
    flow = reals(3, "velocity of the water, on the average", "m/s")
    velocity = reals(3, "of the frame in which all is at rest", "m/s")
    aside = real("1: lines are drawn aside")


SHAPE_WORDS = FirstShape.WORDS


class StringLine(Record):
    """A line of a first shape."""

    first = real("its first mass")
    count = real("how many it has")
    way = reals(3, "horizontal, across it")


class StringItem(Record):
    """A cable of a line of a first shape, or a point body in it."""

    line = real("number of that")
    body = real("1: it is a point body")
    length = real("of a cable", "m")
    weight = real("in water, of a cable for each metre", "N")
    drag = real("1/2 rho CdA, of a cable for each metre", "kg/m")
    mass = real("of a cable", "kg/m")


class StringBody(Record):
    """A free body in a first shape."""

    weight = real("in water", "N")
    drag = real("1/2 rho CdA", "kg/m")
    middle = real("height of its hull's middle above its origin", "m")
    half = real("half of the hull's height", "m")
    lift = real("weight of what the hull displaces; 0: it has none", "N")
    given = real("1: the scene says where it is, 2: it stands there on the floor")
    place = reals(3, "that place", "m")


class StringEnd(Record):
    """An end of a line of a first shape: both of a line follow on each other."""

    kind = real("STRING_...")
    other = real("that body or line; of what is held the row of the constraint")
    arc = real("arc length on that line", "m")
    place = reals(3, "where it is held, or its place from the body's origin", "m")


STRING_LINE_WORDS, STRING_ITEM_WORDS = StringLine.WORDS, StringItem.WORDS
STRING_BODY_WORDS, STRING_END_WORDS = StringBody.WORDS, StringEnd.WORDS
STRING_FREE, STRING_HELD, STRING_AT_BODY, STRING_ON_LINE = 0, 1, 2, 3
STRING_PARTS = 12  # strings that a line without branches is made of


class MotionChange(Record):
    """What a small change of the tow point's motion is now, and when it began; earth frame."""

    position = reals(3, "by how much the place is another one", "m")
    velocity = reals(3, "and its rate", "m/s")
    acceleration = reals(3, "and the rate of that", "m/s2")
    lasted = real("for how long so far", "s")


MOTION_CHANGE_WORDS = MotionChange.WORDS


class FrameInput(Record):
    """What a caller gives of a frame for the end of a step."""

    given = real("which of these, a sum of GIVEN_...; 0: its own motion")
    position = reals(3, "of its origin", "m")
    attitude = reals(3, "roll, pitch and yaw", "rad")
    velocity = reals(3, "of its origin", "m/s")
    attitude_rate = reals(3, "rates of roll, pitch and yaw", "rad/s")


FRAME_INPUTS = FrameInput.WORDS
GIVEN_VELOCITY, GIVEN_POSITION, GIVEN_RATE, GIVEN_ATTITUDE = 1, 2, 4, 8


class PartMotion(Record):
    """How a body or frame moves, in the earth's frame, and what lines pull a frame with."""

    position = reals(3, "of its origin", "m")
    velocity = reals(3, "of its origin", "m/s")
    acceleration = reals(3, "of its origin", "m/s2")
    axes = reals(9, "by rows: its axes in the earth's, columns")
    angular_velocity = reals(3, "of it", "rad/s")
    angular_acceleration = reals(3, "of it", "rad/s2")
    attitude = reals(3, "roll, pitch and yaw", "rad")
    wrench = reals(6, "force [N] and moment [N m] of the lines about a frame's origin")


PART_WORDS = PartMotion.WORDS

# Users of the spare rows (access.spare_row), with the rows that they name, by words of a node: each
# has its own while it is at work. They begin where the stages' velocities are, and go on over their
# accelerations.


class SearchRows(Record, within=Header.stage_velocity):
    """Of a search for an equilibrium, behind those of a look at mesh and limp cable: statics.py."""

    _spare = spare(STAGE_ROWS)
    places = reals(6, "where it began: places and slopes", "m")
    tensions = reals(2, "with which it began", "N")
    bore = real("what the floor bore for long, before it followed the load")


class BeginRows(Record, within=Header.stage_velocity):
    """Of what a run begins with: begin.py."""

    bent = real("by how much each element bends")
    accelerations = reals(6, "that supports leave as they are", "m/s2")


class LimpRows(Record, within=Header.stage_velocity, beside=(SearchRows,)):
    """Of a look at what is limp: limp.py."""

    hung = real("what holds up what hangs there", "N")
    below = real("the same, from below", "N")
    above = real("from above", "N")
    held = real("where it is held")


class MeshRows(Record, within=Header.stage_velocity, beside=(SearchRows,)):
    """Of a look at the mesh: touchdown_mesh.py, bending_mesh.py."""

    gaps = real("over the floor", "m")
    behind = real("what lies behind")
    jumps = real("of r''", "1/m")
    wanted = real("length of elements that is wanted", "m")
    promised = real("the same as far as others let it be", "m")
    spare = real("what may be joined")
    ways = real("along the floor", "m")


class FilterRows(Record, within=Header.stage_velocity):
    """Of what a step's matrix leaves of an error: tension.py, as a step's error is found."""

    left = reals(2, "what is left in tensions", "N")
    _spare = spare(STAGE_ROWS - 2)
    accelerations = reals(6, "of the motion that is filtered", "m/s2")


class SolvedRows(Record, within=Header.stage_velocity):
    """Of tensions that are solved for, at the end of a step: tension.py."""

    places = reals(6, "of the state that is solved for", "m")
    velocities = reals(6, "of it", "m/s")
    accelerations = reals(6, "of it", "m/s2")
    tensions = reals(6, "of it, two of each element", "N")
    rates = reals(6, "of those", "N/s")
    curved = reals(6, "what curvature takes of a rate of stretch")
    strained = reals(6, "rates of strain")


class SoftnessRows(Record, within=Header.stage_velocity, beside=(SolvedRows,)):
    """Of the solution itself for these tensions: tension.py."""

    _spare = spare(SolvedRows.WORDS)
    softness = reals(6, "compliances that are set aside meanwhile")


class AlongRows(Record, within=Header.stage_velocity, beside=(SolvedRows,)):
    """Of sums along lines from an end that is held: rings.py, waves.py. Tensions that were solved
    for may wait meanwhile, whose compliances have been given back."""

    _spare = spare(SolvedRows.WORDS)
    displacements = real("in the first motion along itself, by a unit of gravity", "s2")
    masses = real("at each node", "kg")
    beyond = real("what hangs, or swings, beyond it")
    closed = real("cycles that lines close beyond it")
    times = real("in which sound comes there from the end", "s")
    speeds = real("by which what is before it is stretched", "m/s")


class SlackRows(Record, within=Header.stage_velocity, beside=(SolvedRows,)):
    """Of the tension from which a line is taut again: slack.py, as a step is taken, too."""

    _spare = spare(SolvedRows.WORDS)
    ties = real("how much holds each node")


class ConsistentRows(Record, within=Header.stage_velocity):
    """Of a state that is made consistent between steps, as it was: consistency.py."""

    places = reals(6, "and slopes", "m")
    velocities = reals(6, "of them", "m/s")
    accelerations = reals(6, "before an end's velocity jumped", "m/s2")
    tensions = reals(2, "of it", "N")
    rates = reals(2, "of those", "N/s")


class GivenShapeRows(Record, within=Header.stage_velocity):
    """Of a shape that a scene gives, as it is stretched alike: given_shape.py."""

    given = reals(6, "places and slopes, as they were given", "m")
    even = reals(6, "the same at the last stretch that was found", "m")


class SummaryRows(Record, within=Header.stage_velocity):
    """Of what is read of a state: summary.py."""

    elements = real("of the line, by their numbers")


class ResponseRows(Record, within=Header.stage_velocity):
    """Of a change of the tow point's motion: interface.py."""

    motion = reals(6, "of places and slopes", "m")
    forces = reals(6, "that go with it", "N")
    solution = reals(6, "what all else moves by", "m")


# Elements at a touchdown.
LAYER = 0.4  # smallest element in units of the touchdown layer (EI/w)^(1/3)

# Motions of a system that are coupled, at most, to see what grows: kernels/line/swinging.py.
MOTIONS = 60

# Scratch memory at `gauss`, for one element or node after another. At an element's Gauss points
# each component of a vector has a word for each of three points, and one that counts for nothing.
POINT_WORDS = 4


class ElementPoints(Record, within=Header.gauss):
    """An element at its Gauss points."""

    water = reals(3 * POINT_WORDS, "velocity; of all elements where it is the same at all", "m/s")
    stretch = reals(POINT_WORDS, "|r'|")
    tangent = reals(3 * POINT_WORDS, "r' / |r'|")
    force = reals(3 * POINT_WORDS, "conjugate to r, times the element's length", "N")
    pull = reals(3 * POINT_WORDS, "conjugate to r'", "N")
    bend = reals(3 * POINT_WORDS, "conjugate to r'', over the element's length", "N")
    water_acceleration = reals(3 * POINT_WORDS, "of the water, in waves", "m/s2")
    wet = reals(POINT_WORDS, "share that is wet")
    wet_slope = reals(POINT_WORDS, "what that changes by upwards", "1/m")
    drag = reals(POINT_WORDS, "share by which drag counts")


# Rows of an element's Jacobian have a word for each pair of components: xx, xz, zx, zz in a plane;
# in space xx, xy, ... zz, and one unused, for they are even.
PLANAR_PAIRS, SPATIAL_PAIRS = 4, 10


class PlanarElement(Record, within=Header.gauss):
    """The Jacobian of an element in a plane, as it is made."""

    points = part(ElementPoints, "the element at its Gauss points")
    slope_rows = reals(4 * 3 * PLANAR_PAIRS, "A11, then A12, A21 and A22, each at the three points")
    motion_rows = reals(3 * PLANAR_PAIRS, "A00 at the points")
    mixed_rows = reals(3 * PLANAR_PAIRS, "A01 at the points")
    slope_sums = reals(6 * PLANAR_PAIRS, "over the points, for pairs of slopes")
    motion_sums = reals(10 * PLANAR_PAIRS, "for pairs of shape functions")
    mixed_sums = reals(12 * PLANAR_PAIRS, "for a function and a slope")
    turned = reals(3 * PLANAR_PAIRS, "transposes of the last three pairs of slopes")
    blocks = reals(16 * PLANAR_PAIRS, "the result: all pairs of shape functions")
    gradient = reals(3 * 4 * 2, "of both constraints and the third strain mode, by shape functions")
    a00 = reals(4 * POINT_WORDS, "A00 along and across the cable: tt, tn, nt, nn at the points")
    a01 = reals(4 * POINT_WORDS, "A01 in the same way")
    a11 = reals(4 * POINT_WORDS, "A11 in the same way")
    a12 = reals(4 * POINT_WORDS, "A12 in the same way")
    a22 = reals(4 * POINT_WORDS, "A22 in the same way")


class SpatialElement(Record, within=Header.gauss):
    """The same in space."""

    points = part(ElementPoints, "the element at its Gauss points")
    slope_rows = reals(
        4 * 3 * SPATIAL_PAIRS, "A11, then A12, A21 and A22, each at the three points"
    )
    motion_rows = reals(3 * SPATIAL_PAIRS, "A00 at the points")
    mixed_rows = reals(3 * SPATIAL_PAIRS, "A01 at the points")
    slope_sums = reals(6 * SPATIAL_PAIRS, "over the points, for pairs of slopes")
    motion_sums = reals(10 * SPATIAL_PAIRS, "for pairs of shape functions")
    mixed_sums = reals(12 * SPATIAL_PAIRS, "for a function and a slope")
    turned = reals(3 * SPATIAL_PAIRS, "transposes of the last three pairs of slopes")
    blocks = reals(16 * SPATIAL_PAIRS, "the result: all pairs of shape functions")
    gradient = reals(3 * 4 * 3, "of both constraints and the third strain mode, by shape functions")


class NodeElimination(Record, within=Header.gauss, beside=(ElementPoints,)):
    """Two blocks of the elimination of a node: block_solver.py. The elements' water waits."""

    _spare = spare(ElementPoints.WORDS)
    lower = reals(36, "the block below the diagonal, by rows")
    upper = reals(36, "that above it, by columns")


GAUSS_WORDS = 792  # room for any of them, and more than that: saved states count on it

# Words of the workspace at `motion`; then columns for the components of the waves: four in
# airy.py, and two more in sea_cells.py.
MOTION_WORDS = Motion.WORDS
WATER_COLUMNS = 6

LONGEST_STEP = 1e9  # that a caller may ask for [s]: 30 years; more is a mistake

# Status codes of the kernels.
OK = 0
NOT_CONVERGED, NOT_FINITE, TOO_MANY_STEPS, SINGULAR, STATICS_FAILED = 1, 2, 3, 4, 5
NO_CAPACITY = 6  # the block must grow before this step can be made
STALLED, OVERSTRETCHED = 7, 8
NOTHING, CHANGED = 0, 1  # what a look at the mesh finds, beside NO_CAPACITY
SEARCH = -1  # in place of a status: an equilibrium is to be found next

# Strain from which on a step is refused: rubber breaks before; so long a cable comes from an input
# that is a mistake.
LARGEST_STRAIN = 5.0
