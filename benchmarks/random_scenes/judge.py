"""Judge a scene: by itself at a quarter of its tolerance, by energy, by limits that always hold.
(Runs that are asked to converge: `judge_converged`.)

The promise: positions within tau L, tensions within 10 tau of the largest. A run and one at tau/4
that both keep it differ by at most 5/4 of that. It is asked for as long as the motion can be
predicted: the run at tau/4 is made again with weights, diameters and the water's velocity changed
by a hundredth of tau (see ``trace.perturbed``), and from the time on at which that moves the line
by a tenth of tau L, or changes the tension by a tenth of its allowance, nothing more is compared.
Tensions are compared while the line is taut and not shocked: once it has pushed anywhere, they are
snaps, whose peaks fall between any two instants; and after a command that makes the line ring along
itself (``draw.shock_time``) or a winch that stops dead at its end, the ringing decides them.
An ordinary job (``ordinary.py``) is judged to its end, and its tensions while it is taut.
Where the runs differ by more, a run at tau/16 decides who is right: when it and the one at tau/4
are more than half the promise apart, too, there is nothing to judge by (*unsettled*: a straight
line that is pushed buckles the way its mesh lets it; or the solver does not converge).

What is left for such scenes, as for all: the run completes or says clearly why not; every number is
finite; no cable appears or is stretched beyond its strain; nothing sinks deeper into the floor than
tau L; no energy comes from nowhere; and a line that hangs free in still water, left alone for an
hour or more, carries its weight.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.random_scenes.draw import Drawn
from benchmarks.random_scenes.trace import FloatArray, Trace, ending, perturbed, run
from cablemodel.solvers.estimating import PLACES

if TYPE_CHECKING:
    from cablemodel.results.simulate import Progress

RUN_LIMIT = 30.0
"""CPU seconds that a run may take; more is ``too slow`` [s]."""
CONVERGE_LIMIT = 40.0
"""CPU seconds that all attempts of a run that is asked to converge may take [s]."""
CHECK_LIMIT = 10.0
"""The same for each of the two runs at tau/4 [s]."""
ENERGY_LIMIT = 100.0
"""The same for the run whose energy is looked at more closely [s]."""
WITHIN = 16
"""Parts of a step in that."""
FINER = 0.25
CONVERGED_WITHIN = 1.0 + FINER**3
"""Of the promise: what a run that converged, at tau/4 or less, may differ from a far finer one."""
TOOK = "finer"
"""The statistic that says how many times finer than asked the tolerance of a run was."""
JUDGE_LIMIT = 30.0
"""CPU seconds of the run that judges one that converged [s]."""
RINGING = 100
"""Instants of a line at rest whose tensions are averaged."""
FAINT = 0.01
"""Size of the perturbation over tau."""
MOVED = 0.1
"""Share of the promise by which the perturbed run may differ, where the motion is predictable."""
SETTLED = 0.5
"""Difference between the runs at tau/4 and tau/16, in units of the promise at tau, at most."""
PUSHES = 0.01
"""Compression over the largest tension, from which on a line counts as slack [-]."""
MOST_ENERGY_GAIN = 0.05
"""Energy from nowhere over what went through the cable [-]."""


@dataclass
class Verdict:
    """Outcome of one scene.

    outcome: completed, refused, stopped, unsettled, wrong, crashed, too slow. why: in words, empty
    where completed; kinds: of what is wrong (position, tension, energy, limit, rest, not finite).
    position, tension: largest difference from the finer run, in units of the promise (1.25 is
    allowed where that is at tau/4). compared: share of the run that was. energy_gain as in the
    trace.
    """

    seed: int
    outcome: str
    why: str = ""
    kinds: list[str] = field(default_factory=list)
    position: float = float("nan")
    tension: float = float("nan")
    compared: float = 0.0
    energy_gain: float = float("nan")
    cpu: float = 0.0
    check_cpu: float = 0.0
    statistics: dict[str, int] = field(default_factory=dict)
    note: str = ""


def judge(
    drawn: Drawn, started: Callable[[str, Verdict | None], None] = lambda _phase, _verdict: None
) -> Verdict:
    """Run a scene and judge it.

    ``started`` is called with the name of each run as it begins, and with what the verdict is if it
    does not end; None: that the scene is too slow.
    """
    tau = drawn.tolerance
    started("run", None)
    trace, model = run(drawn, drawn.scene, tau, RUN_LIMIT)
    verdict = Verdict(
        drawn.seed,
        trace.end,
        trace.message,
        energy_gain=trace.energy_gain,
        cpu=trace.cpu,
        statistics=trace.statistics,
    )
    if trace.end in ("crashed", "not finite"):
        if trace.end == "not finite":
            _wrong(verdict, "not finite", trace.message)
        return verdict
    _check_limits(verdict, drawn, tau, trace, started)
    if trace.end == "refused":
        return verdict
    if trace.end == "completed" and model is not None and hangs_free(drawn):
        started("rest", None)
        problem = settled(drawn, model)
        if problem:
            _wrong(verdict, "rest", problem)
    started("check", verdict)
    fine, _ = run(drawn, drawn.scene, tau * FINER, CHECK_LIMIT)
    shaken, verdict.check_cpu = fine, fine.cpu
    if not drawn.predictable:
        started("perturbed", verdict)
        shaken, _ = run(drawn, perturbed(drawn, FAINT * tau), tau * FINER, CHECK_LIMIT)
        verdict.check_cpu += shaken.cpu
    if fine.end in ("crashed", "not finite"):
        _wrong(verdict, fine.end, f"at tau/4: {fine.message}")
    elif fine.broken:
        _wrong(verdict, "limit", f"at tau/4: {'; '.join(fine.broken[:2])}")
    elif fine.end != "completed":
        verdict.note = f"at tau/4: {fine.end}: {fine.message}"
    off = compare(verdict, drawn, trace, fine, shaken)
    if off is not None:
        doubtful = "unsettled" if trace.end == "completed" else trace.end
        started("finest", replace(verdict, outcome=doubtful, kinds=[], why=""))
        finest, _ = run(drawn, drawn.scene, tau * FINER**2, CHECK_LIMIT)
        settle(verdict, drawn, trace, fine, finest, off)
    return verdict


def judge_converged(
    drawn: Drawn, started: Callable[[str, Verdict | None], None] = lambda _phase, _verdict: None
) -> Verdict:
    """Ask a scene to converge, and judge the run by one that no attempt has seen.

    That is at a sixteenth of the tolerance of the run, and is compared with it at all outputs,
    whether the motion can be predicted or not: a run that says that it has converged has no excuse.
    Tensions are asked for where no command makes the line ring along itself, nor a turn, at whose
    ends the acceleration jumps; they count until the line is slack in either run or the winch has
    reached an end. What a ConvergenceError refuses is *unsettled*; *too slow* is also a run whose
    judge does not come to its end.
    """
    import cablemodel as cm

    tensions = drawn.shock > drawn.duration and drawn.traits["manoeuvre"] != "turn"
    asked = {**drawn.scene["solver"], "accuracy_of": "all" if tensions else "positions"}
    verdict = Verdict(drawn.seed, "completed")
    started("converge", None)
    begin = time.process_time()
    try:
        found = cm.converge(cm.load_scene({**drawn.scene, "solver": asked}))
    except Exception as error:
        verdict.outcome, verdict.why = ending(error)
    verdict.cpu = time.process_time() - begin
    if verdict.outcome != "completed":
        return verdict
    tau = found.scene.solver.tolerance
    verdict.statistics = {TOOK: round(drawn.tolerance / tau)}
    started("run", replace(verdict, outcome="too slow", why="what judges it is"))
    trace, _ = run(drawn, drawn.scene, tau, RUN_LIMIT)
    _check_limits(verdict, drawn, tau, trace, started)
    one = _Outputs(drawn, tau, RUN_LIMIT)
    if not np.array_equal(one.top, found.top_tension):
        _wrong(verdict, "another run", "the run cannot be made again")
        return verdict
    started("judge", replace(verdict, outcome="too slow", why="what judges it is"))
    other = _Outputs(drawn, tau * FINER**2, JUDGE_LIMIT)
    verdict.check_cpu = other.cpu
    one.compare(verdict, drawn.tolerance, other, tensions=tensions)
    if other.end and verdict.outcome == "completed":
        verdict.outcome, verdict.why = "too slow", f"what judges it is: {other.end}"
    return verdict


class _TooSlowError(Exception):
    """A run has taken all its processor time."""


class _Outputs:
    """A run with its shape at all outputs; ``end``: why it did not come to its end, or empty."""

    def __init__(self, drawn: Drawn, tolerance: float, limit: float) -> None:
        import cablemodel as cm

        scene = {**drawn.scene, "solver": {**drawn.scene["solver"], "tolerance": tolerance}}
        begin = time.process_time()
        self.shapes: list[FloatArray] = []
        self.lengths: list[float] = []
        self._tensions: list[tuple[float, float, float]] = []
        self._stands: list[bool] = []
        self.end = ""
        try:
            model = cm.CableModel(cm.load_scene(scene))

            def look(_now: Progress) -> None:
                self.shapes.append(model.sample(PLACES * model.line_length).position)
                self.lengths.append(model.line_length)
                tensions = model.top_tension, model.tension_min, model.tension_max
                self._tensions.append(tensions)
                self._stands.append(model.winch != "free")
                if time.process_time() - begin > limit:
                    raise _TooSlowError(f"more than {limit:g} s at t = {model.time:g} s")

            cm.simulate(model.scene, model=model, progress=look)
        except (cm.CableModelError, _TooSlowError) as error:
            self.end = str(error)
        self.top, self.lowest, self.highest = np.array(self._tensions).reshape(-1, 3).T
        self.cpu = time.process_time() - begin

    def compare(self, verdict: Verdict, tau: float, judge: _Outputs, *, tensions: bool) -> None:
        """Fill in the largest differences from the judge, in units of what ``tau`` promises."""
        count = min(len(self.shapes), len(judge.shapes))
        verdict.compared = count / len(self.shapes)
        if not count:
            return
        pairs = zip(self.shapes[:count], judge.shapes[:count], strict=True)
        deviation = [np.linalg.norm(one - other, axis=1).max() for one, other in pairs]
        scale = np.maximum(self.lengths[:count], judge.lengths[:count])
        shares = {"position": np.array(deviation) / (tau * scale)}
        if tensions:
            lowest = np.minimum(self.lowest[:count], judge.lowest[:count])
            largest = max(float(np.abs([judge.lowest, judge.highest]).max()), 1e-9)
            ends = np.flatnonzero((lowest < -PUSHES * largest) | self._stands[:count])
            taut = ends[0] if ends.size else count
            off = np.abs(self.top[:taut] - judge.top[:taut]) / (10.0 * tau * largest)
            shares["tension"] = np.concatenate([off, np.zeros(count - taut)])
        verdict.position = float(shares["position"].max())
        verdict.tension = float(shares["tension"].max()) if tensions else math.nan
        for kind, values in shares.items():
            wrong = np.flatnonzero(~(values <= CONVERGED_WITHIN))
            if wrong.size:
                k = wrong[0]
                why = f"at output {k} of {count} {values[k]:.3g} of what is allowed"
                _wrong(verdict, kind, f"{kind}s {why}, up to {values.max():.3g}")


def settle(
    verdict: Verdict, drawn: Drawn, trace: Trace, fine: Trace, finest: Trace, k: int
) -> None:
    """Call a difference at instant k unsettled where the two finer runs do not agree either.

    A run that stopped later stays one that stopped.
    """
    if len(finest.times) <= k:
        finer = "none: the run at tau/16 did not come so far"
        agree = False
    else:
        scale = drawn.tolerance * fine.lengths[k]
        pull = tension_promise(drawn, fine)
        position = _deviation(fine, finest, k) / scale
        tension = abs(fine.top[k] - finest.top[k]) / pull
        finer = f"tau/4 and tau/16 are {position:.2g} tau L, {tension:.2g} of 10 tau T apart"
        agree = position <= SETTLED and ("tension" not in verdict.kinds or tension <= SETTLED)
    verdict.note = f"{verdict.note} {finer}".strip()
    if not agree and set(verdict.kinds) <= {"position", "tension"}:
        verdict.outcome = "unsettled"
        if trace.end != "completed":
            verdict.outcome, verdict.why = trace.end, trace.message


def _check_limits(
    verdict: Verdict,
    drawn: Drawn,
    tau: float,
    trace: Trace,
    started: Callable[[str, Verdict | None], None],
) -> None:
    """What must hold whether the motion can be predicted or not: limits and energy."""
    if trace.broken:
        _wrong(verdict, "limit", "; ".join(trace.broken[:2]))
    if trace.energy_gain > MOST_ENERGY_GAIN:
        # What goes through between two of the caller's steps may be all of it.
        started("energy", None)
        closer, _ = run(drawn, drawn.scene, tau, ENERGY_LIMIT, WITHIN)
        verdict.energy_gain = trace.energy_gain
        if closer.end == trace.end:
            verdict.energy_gain = closer.energy_gain
        if verdict.energy_gain > MOST_ENERGY_GAIN:
            _wrong(verdict, "energy", f"{verdict.energy_gain:.2g} of the energy from nowhere")


def _wrong(verdict: Verdict, kind: str, why: str) -> None:
    if kind not in verdict.kinds:
        verdict.kinds.append(kind)
    verdict.why = f"{verdict.why}; {why}" if verdict.outcome == "wrong" else why
    verdict.outcome = "wrong"


def compare(verdict: Verdict, drawn: Drawn, trace: Trace, fine: Trace, shaken: Trace) -> int | None:
    """Fill in the largest differences while the motion is predictable; too large ones are wrong.

    Returns the instant of the first one that is too large, or None.
    """
    tau, compared, off = drawn.tolerance, 0, None
    # Over a heavy snap the largest tension of all is what the promise speaks of.
    pull = tension_promise(drawn, fine)
    read = 0 if "initial" in drawn.scene else taut_instants(drawn, fine, trace)
    for k in range(min(len(trace.times), len(fine.times), len(shaken.times))):
        scale = tau * max(fine.lengths[k], trace.lengths[k])
        moved = _deviation(fine, shaken, k) / scale
        pulled = abs(fine.top[k] - shaken.top[k]) / pull if k < read else 0.0
        if not (moved <= MOVED and pulled <= MOVED):
            break
        compared += 1
        position = _deviation(trace, fine, k) / scale
        tension = abs(trace.top[k] - fine.top[k]) / pull if k < read else 0.0
        verdict.position = float(np.fmax(verdict.position, position))
        verdict.tension = float(np.fmax(verdict.tension, tension))
        if not (position <= 1.0 + FINER and tension <= 1.0 + FINER):
            _wrong(
                verdict,
                "tension" if position <= 1.0 + FINER else "position",
                f"at t = {trace.times[k]:.3g} s {position:.2g} tau L and {tension:.2g} of 10 tau T "
                f"({trace.top[k]:.4g}, {fine.top[k]:.4g} N) from the run at tau/4",
            )
            off = k
            break
    verdict.compared = compared / max(len(trace.times), 1)
    return off


def largest_tension(fine: Trace) -> float:
    """Of a whole run, either way [N]."""
    return max((abs(value) for value in fine.highest), default=0.0)


def tension_promise(drawn: Drawn, fine: Trace) -> float:
    """What a tension may be wrong by [N]."""
    return 10.0 * drawn.tolerance * max(largest_tension(fine), 1e-9)


def taut_instants(drawn: Drawn, fine: Trace, *others: Trace) -> int:
    """At how many instants, the first ones, the line is neither slack in any run nor shocked."""
    runs, limit = (fine, *others), -PUSHES * largest_tension(fine)
    rings = min(drawn.shock, *(run.clamped for run in runs))
    count = min(len(run.times) for run in runs)
    for k in range(count):
        if min(run.lowest[k] for run in runs) < limit or fine.times[k] > rings:
            return k
    return count


def _deviation(one: Trace, other: Trace, k: int) -> float:
    return float(np.linalg.norm(one.shapes[k] - other.shapes[k], axis=1).max())


def hangs_free(drawn: Drawn) -> bool:
    """Whether nothing but the vessel carries the line once it has come to rest."""
    scene = drawn.scene
    environment = scene["environment"]
    moves = "current" in environment or "waves" in environment
    still = not moves and environment["water_density"] > 100.0
    free = "floor" not in environment and "end" not in scene
    pinned = "connection" not in scene["vessel"]
    return still and free and pinned and abs(total_weight(drawn)) > 0.2 * _weights(drawn)


def total_weight(drawn: Drawn, length: float | None = None) -> float:
    """Submerged weight of the line [N], with that length of cable out [m]."""
    line = drawn.scene["line"]
    if length is None:
        length = sum(item["cable"]["length"] for item in line if "cable" in item)
    bodies = sum(item["body"]["submerged_weight"] for item in line if "body" in item)
    return float(bodies + length * drawn.scene["cable_types"]["K"]["submerged_weight"])


def _weights(drawn: Drawn) -> float:
    """Sum of the sizes of the weights [N]: small against it, nothing pulls the line straight."""
    cable = drawn.scene["cable_types"]["K"]
    mass = sum(i["cable"]["length"] for i in drawn.scene["line"] if "cable" in i) * cable["mass"]
    bodies = sum(abs(i["body"]["submerged_weight"]) for i in drawn.scene["line"] if "body" in i)
    return float(bodies + mass * drawn.scene["environment"]["gravity"])


def settled(drawn: Drawn, model: Any) -> str:
    """Stop vessel and winch, wait until the line hangs; says what is then wrong, or nothing."""
    import cablemodel as cm

    hours = _time_to_fall(drawn, model.line_length) / 3600.0
    try:
        model.step(5.0, vessel_velocity=(0.0, 0.0, 0.0), payout_rate=0.0)
        for _ in range(math.ceil(36.0 * hours)):
            model.step(100.0, vessel_velocity=(0.0, 0.0, 0.0), payout_rate=0.0)
        # What rings along a wire is hardly damped: the mean over many turns is the weight.
        pulls = []
        for _ in range(RINGING):
            model.step(math.sqrt(0.5), vessel_velocity=(0.0, 0.0, 0.0), payout_rate=0.0)
            pulls.append(-model.top_force[2])
    except cm.StepError as error:
        return f"did not come to rest: {error}"
    weight = total_weight(drawn, model.line_length)
    carried = sum(pulls) / RINGING
    bodies_out = len(model.bodies) == sum("body" in item for item in drawn.scene["line"])
    if bodies_out and abs(carried - weight) > 0.02 * abs(weight):
        return f"after {hours:.3g} h at rest the top carries {carried:.4g} N of {weight:.4g} N"
    return ""


def _time_to_fall(drawn: Drawn, length: float) -> float:
    """An hour, or twice the time in which its weight moves the line broadside by its length [s]."""
    cable = drawn.scene["cable_types"]["K"]
    drag = 0.5 * drawn.scene["environment"]["water_density"] * cable["drag_normal"]
    pull = abs(total_weight(drawn, length))
    return max(3600.0, 2.0 * length * math.sqrt(drag * cable["diameter"] * length / pull))
