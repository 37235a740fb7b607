"""Numbers that Python and C share: value references, words and flags of model files.

c_layout.py writes them into layout.h.
"""

# Value references, of all types: no two variables have the same, for there are masters that keep
# them in one table.
VR_VELOCITY, VR_POSITION, VR_PAYOUT, VR_CURRENT = 0, 3, 6, 7
VR_INPUTS = 10  # how many inputs of a line there are
VR_USE_SCENE_INPUTS = 10  # the only Boolean
VR_VESSEL_INPUT, VR_INPUT_TIMING = 11, 12  # the Integers, enumerations
VR_START, VR_START_VELOCITY = 20, 23  # of the tow point
VR_STARTS = 6  # their words: position, velocity
VR_PARAMETER = 100
VR_ZERO = 900
VR_ERROR = 950
VR_SUMMARY = 1000
VR_STATION = 10_000
VR_BODY = 20_000_000
# Of a system: inputs of its parts, what moves each vessel (Integers), outputs, starts of vessels.
VR_SYSTEM_INPUT, VR_SYSTEM_CHOICE = 100_000_000, 200_000_000
VR_SYSTEM_OUTPUT, VR_SYSTEM_START = 300_000_000, 400_000_000

# Of resources/model.bin and of finer.bin: file_records.py.
FILE_MAGIC = 0x554D46454C424143  # "CABLEFMU"
FILE_FORMAT = 5

FLAG_SCENE_INPUTS = 1
FLAG_STATIC = 2
FLAG_PINNED = 4
FLAG_ESTIMATE = 8  # finer.bin is beside it
FLAG_IGNORE = 16  # inputs, while use_scene_inputs is true
FLAG_MOVABLE = 32  # the start of the tow point, or of vessels, may be set
FLAG_AT_START = 64  # input.timing begins as 2
FLAG_VESSEL_INPUT_UNIT = 128  # what vessel.input begins as, times this
FLAG_VESSEL_INPUT = 3 * FLAG_VESSEL_INPUT_UNIT
FLAG_LEVEL = 512  # the tow point's start may be moved along a level floor, and all that lies there
FLAG_LEAVES = 1024  # small motions about the exported start may grow by themselves

# A coefficient of a cable type, of a body in a line or of a free body; the length of a cable of the
# line or on the drum.
OF_CABLES, OF_BODY, OF_FREE, OF_LINE, OF_DRUM = range(5)

# Word of a saved state at which the StepInputs of the last step begin; its length is behind them.
STATE_APPLIED = 10
