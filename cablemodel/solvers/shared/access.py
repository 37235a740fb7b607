"""The block's records in kernels: by name, without a copy (layout.py declares them).

``edge_of(I, M, n)`` is row n of the table of edges, ``edge_at(M, word)`` the edge at a word of the
block; so for the others.
"""

from cablemodel.solvers.shared.compile import (
    inlined,
    own_numbers,
    own_record,
    record_at,
    record_in,
    row_of,
    word_of,
)
from cablemodel.solvers.shared.layout import (
    ArcLaw,
    Arm,
    Body,
    Cable,
    CableLength,
    Cell,
    Closure,
    Constraint,
    Cut,
    Edge,
    ElementPoints,
    ElementTension,
    Energies,
    FirmHold,
    FirstShape,
    FloorPlace,
    Foil,
    FoilRow,
    Foot,
    Frame,
    FrameInput,
    FreeBody,
    Header,
    InverseCompliance,
    Layer,
    Line,
    LineFacts,
    Matter,
    Motion,
    MotionChange,
    PartMotion,
    Piece,
    PlanarElement,
    Polynomial,
    Rate,
    Scalars,
    Settling,
    SpatialElement,
    StartMove,
    Station,
    StepInputs,
    StringBody,
    StringEnd,
    StringItem,
    StringLine,
    Summary,
    WaveResponse,
    Winch,
)

__all__ = ["word_of"]

header = record_in(Header)
"""header(I): identity, sizes, counters, and the words where arrays start."""

header_at = record_at(Header)
"""header_at(I, word): that of a copy of the block, at a word of the block."""

scalars = record_in(Scalars)
"""scalars(M): the numbers that there is one of."""

edge_of, edge_at = row_of(Edge, Header.edges), record_at(Edge)
cable_of, cable_at = row_of(Cable, Header.cables), record_at(Cable)
body_of, body_at = row_of(Body, Header.bodies), record_at(Body)
constraint_of, constraint_at = row_of(Constraint, Header.constraints), record_at(Constraint)
motion_piece_of, motion_piece_at = row_of(Piece, Header.pieces), record_at(Piece)
polynomial_at, arc_at = record_at(Polynomial), record_at(ArcLaw)
frame_of, frame_at = row_of(Frame, Header.frames), record_at(Frame)
free_body_of, free_body_at = row_of(FreeBody, Header.free_bodies), record_at(FreeBody)
arm_of, arm_at = row_of(Arm, Header.arms), record_at(Arm)
closure_of, closure_at = row_of(Closure, Header.closures), record_at(Closure)
foil_of, foil_at = row_of(Foil, Header.foils), record_at(Foil)
rate_of = row_of(Rate, Header.rates)
winch_of, winch_at = row_of(Winch, Header.winches), record_at(Winch)
matter_of = row_of(Matter, Header.matter)
line_of, line_at = row_of(Line, Header.lines), record_at(Line)
cut_of, cut_at = row_of(Cut, Header.cuts), record_at(Cut)
foot_of, foot_at = row_of(Foot, Header.feet), record_at(Foot)
cell_of = row_of(Cell, Header.cells)
line_facts_at = record_at(LineFacts)
cable_length_at = record_at(CableLength)
start_move_at = record_at(StartMove)
firm_hold_at = record_at(FirmHold)
first_shape_at = record_at(FirstShape)
settling_at = record_at(Settling)
string_line_at, string_item_at = record_at(StringLine), record_at(StringItem)
string_body_at, string_end_at = record_at(StringBody), record_at(StringEnd)
sea_layer_at = record_at(Layer)
tension_of, tension_at = row_of(ElementTension, Header.tension), record_at(ElementTension)
tension_rate_of = row_of(ElementTension, Header.tension_rate)
trial_tension_of = row_of(ElementTension, Header.trial_tension)
compliance_of = row_of(InverseCompliance, Header.compliance)
floor_place_at = record_at(FloorPlace)
wave_response_at = record_at(WaveResponse)
foil_row_at = record_at(FoilRow)
element_points = row_of(ElementPoints, Header.gauss)
planar_element = row_of(PlanarElement, Header.gauss)
spatial_element = row_of(SpatialElement, Header.gauss)
"""spatial_element(I, M, 0), and so for the others: the scratch memory of an element by name."""

tow_point_of = row_of(Motion, Header.motion)
"""tow_point_of(I, M, 0): its motion at the last set_time, earth frame."""

motion_at = record_at(Motion)
new_motion = own_record(Motion)
summary_at = record_at(Summary)
energies_at = record_at(Energies)
motion_change_at = record_at(MotionChange)
step_inputs_at = record_at(StepInputs)
frame_input_at = record_at(FrameInput)
station_at = record_at(Station)
part_motion_at = record_at(PartMotion)


@inlined
def spare_row(I, row):
    """Where words for the nodes begin, `capacity` of them, in the memory of a step's stages, which
    is free where none is under way. Users and their rows are declared in layout.py."""
    head = header(I)
    return head.stage_velocity + row * head.capacity


vector = own_numbers(3)
"""vector(): three zeros of the caller's own; those of a planar model are the first two."""

matrix = own_numbers(9)
"""matrix(): nine zeros, (3, 3) by rows."""
