"""The kernels' entry points: all that Python, the FMU and the ROS 2 node call.

Each takes the instance block twice, as int64 (I) and as float64 (M), and returns an int status or
a count; see layout.py for the codes.
"""

from numba import float64, int64

from cablemodel.solvers.finite_element.kernels.bodies import frames
from cablemodel.solvers.finite_element.kernels.element import stabilisation
from cablemodel.solvers.finite_element.kernels.line import inertia, swinging, system
from cablemodel.solvers.finite_element.kernels.mesh import (
    bending_mesh,
    mesh_motion,
    resizing,
    touchdown_mesh,
)
from cablemodel.solvers.finite_element.kernels.mesh import lengths as mesh_lengths
from cablemodel.solvers.finite_element.kernels.outputs import (
    energies,
    interface,
    part_outputs,
    stations,
)
from cablemodel.solvers.finite_element.kernels.outputs.summary import summarise
from cablemodel.solvers.finite_element.kernels.start import (
    at_rest,
    firm_friction,
    growth,
    settling,
    strings,
)
from cablemodel.solvers.finite_element.kernels.time import (
    begin,
    given_shape,
    promote,
    statics,
    stepping,
)
from cablemodel.solvers.shared import environment
from cablemodel.solvers.shared.access import header, scalars
from cablemodel.solvers.shared.compile import INTEGERS, REALS, entry_point, view
from cablemodel.solvers.shared.layout import (
    FLOOR_FAR,
    NOTHING,
)


@entry_point(int64(INTEGERS, REALS, float64, REALS))
def step(I, M, t_end, inputs):
    """Step to t_end [s] with the inputs of stepping.take_step (StepInputs). Returns the status.

    On failure the block's image is as it was.
    """
    return stepping.take_step(I, M, t_end, inputs)


@entry_point(int64(INTEGERS, REALS, REALS))
def equilibrium(I, M, frame):
    """Static equilibrium in a frame moving at `frame` (dimension words). Returns the status."""
    return statics.find_equilibrium(I, M, frame)


@entry_point(int64(INTEGERS, REALS, float64))
def stretch_evenly(I, M, wanted):
    """Stretch all cable of a shape that is given alike: given_shape.stretch_evenly."""
    given_shape.stretch_evenly(I, M, wanted)
    return 0


@entry_point(int64(INTEGERS, REALS))
def tension_from_stretch(I, M):
    """Set the tensions that belong to the stretch of the block's positions."""
    given_shape.stretch_to_tension(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def stabilise(I, M):
    """Stabilise what tensions do not hold, by those of a start: returns whether it was changed."""
    return stabilisation.stabilise(I, M)


@entry_point(int64(INTEGERS, REALS))
def choose_bending(I, M):
    """Decide whether a hybrid's elements keep bending, and how stiff clamps are."""
    at_rest.choose_bending(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def refine_at_floor(I, M):
    """Adapt the mesh to the floor once: returns what `touchdown_mesh.follow_floor` does."""
    head = header(I)
    if head.floor_state == FLOOR_FAR:
        return NOTHING
    return touchdown_mesh.follow_floor(I, M, True, 0)


@entry_point(int64(INTEGERS, REALS, REALS))
def begin_to_hold(I, M, hold):
    """Before friction takes hold at a start: firm_friction.begin_to_hold; fills a FirmHold."""
    return firm_friction.begin_to_hold(I, M, hold)


@entry_point(int64(INTEGERS, REALS, int64, REALS, REALS))
def go_on_holding(I, M, status, hold, before):
    """Between the equilibria on that way: firm_friction.go_on_holding."""
    return firm_friction.go_on_holding(I, M, status, hold, before)


@entry_point(int64(INTEGERS, REALS, float64))
def draw_alike(I, M, bristle):
    """Bristles of another length [m]: firm_friction.draw_alike."""
    firm_friction.draw_alike(I, M, bristle)
    return 0


@entry_point(int64(INTEGERS, REALS, int64, REALS, REALS))
def go_on_settling(I, M, status, at, kept):
    """Between the equilibria by which a system comes to rest: settling.go_on_settling. at: a
    Settling, zeros at first; kept: room for two images."""
    return settling.go_on_settling(I, M, status, at, kept)


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def find_first_shape(I, M, shape, work):
    """Places of the masses of a FirstShape: strings.find_first_shape. Returns 0, or how many words
    of work it needs."""
    return strings.find_first_shape(I, M, shape, work)


@entry_point(int64(INTEGERS, REALS, REALS))
def place_on_shape(I, M, shape):
    """Nodes of a system along a FirstShape: strings.place_on_shape."""
    return strings.place_on_shape(I, M, shape)


@entry_point(int64(INTEGERS, REALS, REALS, float64))
def halve_bent(I, M, bends, allowed):
    """Halve elements of a static shape that bend too much: bending_mesh.halve_bent."""
    return bending_mesh.halve_bent(I, M, bends, allowed)


@entry_point(int64(INTEGERS, REALS, REALS))
def measure_bends(I, M, out):
    """By how much elements of a static shape bend: begin.bends. Returns how many."""
    begin.bends(I, M, out)
    return header(I).nodes


@entry_point(int64(INTEGERS, REALS, REALS))
def worst_of_shape(I, M, out):
    """The most that elements of a static shape bend and stretch, and by what lines are pressed:
    begin.worst_of_shape, 3 words."""
    begin.worst_of_shape(I, M, out)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS))
def ends_apart(I, M, out):
    """How far apart ends of lines are that are held: begin.ends_apart. Returns how many lines."""
    begin.ends_apart(I, M, out)
    return header(I).line_count


@entry_point(int64(INTEGERS, REALS))
def place_supports(I, M):
    """Write the prescribed motion at the present time into the state."""
    begin.place_supports(I, M)
    return header(I).constraint_count


@entry_point(int64(INTEGERS, REALS))
def hold_supports(I, M):
    """The same of a shape at rest: begin.hold_supports."""
    begin.hold_supports(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def rest_here(I, M):
    """Make the present shape the place of rest: begin.rest_here."""
    begin.rest_here(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def count_from_zero(I, M):
    """Forget what finding the start took: begin.count_from_zero."""
    begin.count_from_zero(I)
    return 0


@entry_point(int64(INTEGERS, REALS))
def end_search(I, M):
    """The same, and bending is chosen: at_rest.end_search."""
    at_rest.end_search(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def restore_bending(I, M):
    """Bending as it is before tensions are known: begin.restore_bending."""
    begin.restore_bending(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def start_flow(I, M):
    """Material velocity of a line that a winch pays out from the start on: begin.start_flow."""
    begin.start_flow(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS))
def stop_flow(I, M, frame):
    """A line that a winch pays out as it stands in its shape: begin.stop_flow."""
    begin.stop_flow(I, M, frame)
    return 0


@entry_point(int64(INTEGERS, REALS, float64))
def count_growing(I, M, rate):
    """Of small motions how many grow faster than a rate [1/s]: inertia.count_growing. Uses the
    block up."""
    return inertia.count_growing(I, M, rate)


@entry_point(int64(INTEGERS, REALS, float64, REALS))
def count_leaving(I, M, rate, work):
    """The same of a start, by what it is: growth.count_leaving. Without room for that, returns how
    much it needs."""
    if len(work) < growth.leaving_words(I):
        return growth.leaving_words(I)
    return growth.count_leaving(I, M, rate, work)


@entry_point(int64(INTEGERS, REALS, REALS))
def motion_matrices(I, M, out):
    """Stiffness, damping and mass: swinging.find_matrices. Uses the matrix up."""
    words = swinging.matrix_words(I)
    swinging.find_matrices(
        I, M, view(out, 0, words), view(out, words, words), view(out, 2 * words, words)
    )
    return words


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def measure(I, M, lengths, facts):
    """Write what follows from the lengths of lines as a whole: lengths.measure."""
    mesh_lengths.measure(I, M, lengths, facts)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS))
def arrange(I, M, lengths):
    """Complete tables that are filled: lengths.arrange, and elements' stabilisation."""
    mesh_lengths.arrange(I, M, lengths)
    mesh_lengths.forget_stabilisation(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS))
def forget_stabilisation(I, M):
    """Elements as they are before tensions are known: lengths.forget_stabilisation."""
    mesh_lengths.forget_stabilisation(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS))
def move_start(I, M, move):
    """Move the tow point's start: resizing.move_start."""
    resizing.move_start(I, M, move)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS, REALS))
def resize_line(I, M, lengths, facts, move):
    """Give a line alone other lengths and another start: resizing.resize_line."""
    resizing.resize_line(I, M, lengths, facts, move)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS, REALS))
def resize_lines(I, M, lengths, places, grown):
    """Give the lines of a system other lengths: resizing.resize_lines."""
    resizing.resize_lines(I, M, lengths, places, grown)
    return 0


@entry_point(int64(INTEGERS, REALS, float64, float64, float64))
def rotate_system(I, M, x, y, angle):
    """Turn a system about a vertical: mesh_motion.rotate_system."""
    mesh_motion.rotate_system(I, M, x, y, angle)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS, REALS))
def follow_supports(I, M, before, grown, work):
    """Nodes of a system after supports that were moved: mesh_motion.follow_supports. Without room
    for that, returns how many words of work it needs."""
    words = mesh_motion.FOLLOW_WORDS * header(I).nodes
    if len(work) < words:
        return words
    mesh_motion.follow_supports(I, M, before, grown, work)
    return 0


@entry_point(int64(INTEGERS, REALS))
def start_flowing(I, M):
    """Velocities of what hangs on winches that run at first: begin.start_flowing."""
    return begin.start_flowing(I, M)


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def sample(I, M, places, out):
    """State at arc lengths [m]; out: rows of STATION_WORDS. Returns how many are on it."""
    return stations.sample_stations(I, M, places, out)


@entry_point(int64(INTEGERS, REALS, REALS))
def bodies(I, M, out):
    """Motion of bodies of finite length; out: rows of STATION_WORDS, see stations.body_stations."""
    head = header(I)
    stations.body_stations(I, M, out)
    return head.rigid


@entry_point(int64(INTEGERS, REALS, REALS))
def summary(I, M, out):
    """The numbers of outputs/summary.py (SUMMARY_WORDS)."""
    summarise(I, M, out)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS))
def energy(I, M, out):
    """Energies and powers of the state: see energies.energies (ENERGY_WORDS)."""
    head = header(I)
    energies.energies(I, M, out)
    return head.body_count


@entry_point(int64(INTEGERS, REALS, float64, float64))
def assemble(I, M, cv, ca):
    """Effective Jacobian K + cv C + ca M at the present state into the block's matrix arrays."""
    system.assemble_here(I, M, cv, ca)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def residual(I, M, forces, constraint):
    """What the equations of motion leave at the present state, with the water's acceleration of the
    time to come: forces conjugate to places and slopes, 2 dimension words a node, and what is left
    of |r'| = 1 + strain(T), two words a node."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    system.set_time(I, M, state.time)
    environment.current_rate(I, M, state.time, True)
    system.residual(
        I,
        M,
        M[head.position : head.position + count],
        M[head.velocity : head.velocity + count],
        M[head.acceleration : head.acceleration + count],
        M[head.tension : head.tension + 2 * head.nodes],
        forces,
        constraint,
    )
    return 0


@entry_point(int64(INTEGERS, REALS, float64, REALS))
def force_rate(I, M, last_step, out):
    """Time derivative of the force on the vessel: interface.rate_of_force. Uses the block up."""
    interface.rate_of_force(I, M, last_step, out)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def force_response(I, M, motion, out):
    """Change of the force on the vessel with its motion: interface.response_to_motion. Uses the
    block up."""
    return interface.response_to_motion(I, M, motion, out)


@entry_point(int64(INTEGERS, REALS, float64, REALS))
def wrenches_when_moved(I, M, length, out):
    """What lines pull frames with that were moved: interface.wrenches_when_moved. Uses the block
    up."""
    return interface.wrenches_when_moved(I, M, length, out)


@entry_point(int64(INTEGERS, REALS, float64, REALS, REALS, REALS, REALS, REALS))
def drive(I, M, t_end, motion, forces, angles, rates, orders):
    """Inputs of a system for a step to t_end [s], before `step`.

    motion: a FrameInput for each frame, see frames.drive_frame. forces: outside force [N] and
    torque [N m] on each free body, earth frame. angles: deflection of each foil [rad]. rates: of
    each winch whether its rate is given, and that [m/s]. orders: of each cut, whether it is to be
    made now.
    """
    part_outputs.drive_parts(I, M, t_end, motion, forces, angles, rates, orders)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS))
def frame_motion(I, M, motion):
    """How a system's frames move now: frames.read_frames, a FrameInput of each."""
    frames.read_frames(I, M, motion)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS, REALS))
def sample_elements(I, M, elements, fractions, out):
    """State at places within elements, by their numbers; out: rows of STATION_WORDS."""
    part_outputs.element_stations(I, M, elements, fractions, out)
    return len(elements)


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def tension_ranges(I, M, elements, out):
    """Lowest and highest tension of elements, by their numbers; out: both of each."""
    part_outputs.tension_ranges(I, M, elements, out)
    return len(elements)


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def floor_of_line(I, M, elements, out):
    """What the floor does to a line of a system: those numbers of a Summary.

    elements: of the line from its beginning on, by their numbers; their order changes.
    """
    part_outputs.floor_of_line(I, M, elements, out)
    return len(elements)


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def parts(I, M, bodies, frames):
    """Motion of bodies and frames, and what lines pull frames with: part_outputs.parts_motion."""
    head = header(I)
    part_outputs.parts_motion(I, M, bodies, frames)
    return head.body_count


@entry_point(int64(INTEGERS, REALS))
def to_three_dimensions(I, M):
    """Turn a planar model into a three-dimensional one, in place."""
    promote.promote(I, M)
    return 0


ENTRY_POINTS = {
    "step": step,
    "equilibrium": equilibrium,
    "stretch_evenly": stretch_evenly,
    "tension_from_stretch": tension_from_stretch,
    "stabilise": stabilise,
    "choose_bending": choose_bending,
    "refine_at_floor": refine_at_floor,
    "begin_to_hold": begin_to_hold,
    "go_on_holding": go_on_holding,
    "draw_alike": draw_alike,
    "go_on_settling": go_on_settling,
    "find_first_shape": find_first_shape,
    "place_on_shape": place_on_shape,
    "halve_bent": halve_bent,
    "measure_bends": measure_bends,
    "worst_of_shape": worst_of_shape,
    "ends_apart": ends_apart,
    "place_supports": place_supports,
    "hold_supports": hold_supports,
    "rest_here": rest_here,
    "count_from_zero": count_from_zero,
    "end_search": end_search,
    "restore_bending": restore_bending,
    "start_flow": start_flow,
    "stop_flow": stop_flow,
    "count_growing": count_growing,
    "count_leaving": count_leaving,
    "motion_matrices": motion_matrices,
    "measure": measure,
    "arrange": arrange,
    "forget_stabilisation": forget_stabilisation,
    "move_start": move_start,
    "resize_line": resize_line,
    "resize_lines": resize_lines,
    "rotate_system": rotate_system,
    "follow_supports": follow_supports,
    "start_flowing": start_flowing,
    "sample": sample,
    "bodies": bodies,
    "summary": summary,
    "energy": energy,
    "assemble": assemble,
    "residual": residual,
    "force_rate": force_rate,
    "force_response": force_response,
    "wrenches_when_moved": wrenches_when_moved,
    "drive": drive,
    "frame_motion": frame_motion,
    "sample_elements": sample_elements,
    "tension_ranges": tension_ranges,
    "floor_of_line": floor_of_line,
    "parts": parts,
    "to_three_dimensions": to_three_dimensions,
}
