"""What a coupling may use: when a value holds, derivatives of the force by time and by motion."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import CABLE, Slave, assert_same_bits, still_scene, unpacked

import cablemodel as cm

ROOT = Path(__file__).parents[2]
STATIONS = 3


def anchored(**line):
    return cm.load_scene(
        {
            "cable_types": {"K": {**CABLE, **line}},
            "line": [{"cable": {"type": "K", "length": 100}}],
            "end": {"anchor": [100.6, 0, -1]},
            "run": {"duration": 20, "output_interval": 0.1},
        }
    )


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    with unpacked(still_scene(), tmp_path_factory.mktemp("fmu"), stations=STATIONS) as found:
        yield found


@pytest.fixture(scope="module")
def taut(tmp_path_factory):
    with unpacked(anchored(), tmp_path_factory.mktemp("fmu"), stations=STATIONS) as found:
        yield found


def test_a_taut_line_does_not_drive_the_vessel(capsys):
    """5 t on 1e4 N/m, steps of 0.1 s. What holds both values grows as 1.5 k H / 2 m says, one step
    of that is cured by the FMU's extrapolation, the rest by derivatives."""
    found = runpy.run_path(str(ROOT / "examples" / "taut_line.py"))["main"]()
    rate = 1e4 * 0.1 / (2 * 5000.0)
    assert found["plain"] == pytest.approx(1.5 * rate, rel=0.1)
    assert found["timing"] == pytest.approx(0.5 * rate, rel=0.1)
    assert found["timing, derivatives"] < 1.1 * (1e4 / 5000) ** 2 * 0.1**3 / 2
    assert found["derivatives"] < 1e-4
    assert found["newton"] < 1e-4
    assert "newton" in capsys.readouterr().out


# -- when a value holds ----------------------------------------------------------------------------


def test_a_value_at_the_start_goes_on_as_in_the_step_before(still):
    """The end of a step by its slope in the last one, held in the first; steps may vary."""
    slave, model = Slave(*still, **{"input.timing": 2}), cm.CableModel(still_scene())
    rng = np.random.default_rng(1)
    before = last = None
    for dt in (0.5, 0.5, 0.25, 1.0, 0.4):
        velocity = rng.uniform(-0.3, 0.3, 3)
        rate, current = rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1, 3)
        values = np.array([*velocity, rate, *current])
        slave.set("vessel.velocity", velocity)
        slave.set("payout.rate", rate)
        slave.set("current.velocity", current)
        end = values if last is None else values + dt / last * (values - before)
        slave.step(dt)
        model.step(dt, vessel_velocity=end[:3], payout_rate=end[3], current=end[4:])
        assert_same_bits(slave, model, STATIONS)
        before, last = values, dt
    slave.close()


def test_a_motion_at_the_start_goes_on_by_its_own_velocity(still):
    slave = Slave(*still, **{"input.timing": 2, "vessel.input": 3})
    model = cm.CableModel(still_scene())
    place, speed, gain, dt = np.array([5.0, 3.0, 0.0]), np.zeros(3), np.array([0.2, 0.0, 0.1]), 0.25
    before = speed
    for n in range(8):
        slave.set("vessel.position", place)
        slave.set("vessel.velocity", speed)
        slave.step(dt)
        change = dt / dt * (speed - before) if n else np.zeros(3)
        slope = (speed - before) / dt if n else np.zeros(3)
        model.step(
            dt,
            vessel_velocity=speed + change,
            vessel_position=place + dt * (speed + 0.5 * dt * slope),
            payout_rate=0.0,
            current=(0, 0, 0),
        )
        assert_same_bits(slave, model, STATIONS)
        place, before, speed = place + dt * (speed + 0.5 * dt * gain), speed, speed + dt * gain
    # From the second step on it is where the vessel will be.
    np.testing.assert_allclose(slave.get("line.position")[:3], place, atol=1e-12)
    slave.close()


@pytest.fixture(scope="module")
def under_way(tmp_path_factory):
    data = still_scene().to_dict()
    data["vessel"] = {"position": [5, 3, 0], "velocity": [{"t": 0, "velocity": [1, 0, 0]}]}
    data["payout"]["rate"] = 0.1
    scene = cm.load_scene(data)
    folder = tmp_path_factory.mktemp("fmu")
    with unpacked(scene, folder, stations=STATIONS, timing="start") as found:
        yield scene, found


@pytest.mark.parametrize("first", [0, 3])
@pytest.mark.parametrize("how", [2, 3])
def test_a_position_that_takes_over_goes_on_as_fast_as_the_vessel_is(under_way, first, how):
    """From the start, or from the scene later: a steady tow goes on, also from a state taken back;
    what may be position and velocity is the position, where that alone is given."""
    scene, found = under_way
    slave, model = Slave(*found, vessel_input=how), cm.CableModel(scene)
    for n, dt in enumerate([0.5, 0.25, 0.5, 0.5, 0.25, 0.5]):
        time = slave.time
        if n == first:
            kept = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
            slave.step(dt)  # not as it goes on
            slave.close()
            slave = Slave(*found, vessel_input=how)
            slave.fmu.setFMUstate(slave.fmu.deSerializeFMUstate(kept))
            slave.time = time
        if n >= first:
            slave.set("vessel.position", (5 + time, 3.0, 0.0))
        slave.step(dt)
        model.step(dt)
        np.testing.assert_allclose(
            slave.get("line.position")[:3], [5 + slave.time, 3, 0], atol=1e-12
        )  # fmt: skip
        assert slave.get("tension.top") == pytest.approx(model.top_tension, rel=1e-6)
    assert slave.messages == []
    slave.close()


def test_what_takes_over_from_the_scene_has_no_step_before(under_way):
    """It holds in its first step, not going on from what it was at t = 0; derivatives know that."""
    scene, found = under_way
    slaves, model = [Slave(*found, **{"input.timing": n}) for n in (2, 1)], cm.CableModel(scene)
    given = {"vessel.velocity": (1.2, 0, 0), "payout.rate": 0.2, "current.velocity": (0.3, 0, 0)}
    for n in range(4):
        for slave in slaves:
            for name, value in given.items() if n == 3 else ():
                slave.set(name, value)
            slave.step(0.5)
        last = given if n == 3 else {}
        model.step(
            0.5,
            vessel_velocity=last.get("vessel.velocity"),
            payout_rate=last.get("payout.rate"),
            current=last.get("current.velocity"),
        )
    assert_same_bits(slaves[0], model, STATIONS)
    first, second = (by_motion(slave, "vessel.velocity").tobytes() for slave in slaves)
    assert first == second
    for slave in slaves:
        slave.close()


def test_derivatives_of_the_master_go_before(still):
    """With input.timing 2 as with 1: the master knows where its value goes."""
    slaves = [Slave(*still, **{"input.timing": timing}) for timing in (1, 2)]
    for slave in slaves:
        reference = slave.references["vessel.velocity[1]"].valueReference
        for n in range(4):
            slave.set("vessel.velocity", (0.1 * n, 0, 0))
            slave.fmu.setRealInputDerivatives([reference], [1], [0.2])
            slave.step(0.5)
    first, second = (slave.get("end.position").tobytes() for slave in slaves)
    assert first == second
    for slave in slaves:
        slave.close()


@pytest.mark.parametrize("value", [0, 3])
def test_a_timing_that_there_is_not(still, value):
    slave = Slave(*still, begin=False)
    with pytest.raises(FMICallException):
        slave.set("input.timing", value)
    assert "input.timing" in slave.messages[0][1]
    slave.close()


def test_an_export_may_choose_the_timing(tmp_path):
    with unpacked(still_scene(), tmp_path, timing="start") as (place, description):
        slave = Slave(place, description)
        timing = slave.references["input.timing"]
        assert (timing.start, timing.type) == ("2", "Enumeration")
        assert slave.fmu.getInteger([timing.valueReference]) == [2]
        slave.close()


# -- derivatives -----------------------------------------------------------------------------------


def drive(slave, steps: int, dt: float) -> None:
    for n in range(1, steps + 1):
        t = n * dt
        slave.set("vessel.velocity", (0.1 * np.sin(t), 0.02, 0.05 * np.sin(t)))
        slave.step(dt)


def rates(slave) -> np.ndarray:
    names = ["force.top[1]", "force.top[2]", "force.top[3]", "tension.top"]
    references = [slave.references[name].valueReference for name in names]
    return np.array(slave.fmu.getRealOutputDerivatives(references, [1] * 4))


def forces(slave) -> np.ndarray:
    return np.array([*slave.get("force.top"), slave.get("tension.top")])


@pytest.mark.parametrize("dt", [0.1, 0.5])
def test_the_rate_of_the_force(taut, dt):
    """Against the difference of forces over a quarter of a step that goes on with the motion."""
    slave = Slave(*taut)
    drive(slave, 40, dt)
    state = slave.fmu.getFMUstate()
    rate, now = rates(slave), forces(slave)
    gain = 0.1 * (np.sin(40 * dt) - np.sin(39 * dt)) / dt
    reference = slave.references["vessel.velocity[1]"].valueReference
    later = dt / 4
    slave.set("vessel.velocity", (0.1 * np.sin(40 * dt) + gain * later, 0.02,
                                  0.05 * np.sin(40 * dt) + 0.5 * gain * later))  # fmt: skip
    slave.step(later)
    difference = (forces(slave) - now) / later
    np.testing.assert_allclose(rate, difference, atol=0.03 * np.abs(difference).max())
    slave.fmu.setFMUstate(state)
    assert rates(slave).tobytes() == rate.tobytes()
    assert reference == 0
    slave.close()


def test_what_is_asked_changes_nothing(taut):
    """Derivatives work on a copy: the run goes on bit by bit."""
    asked, plain = Slave(*taut), Slave(*taut)
    for slave in (asked, plain):
        for n in range(5):
            slave.set("vessel.velocity", (0.1 * n, 0.02 * n, 0.0))  # it leaves its plane
            slave.step(0.1)
            if slave is asked:
                rates(slave)
                by_motion(slave, "vessel.velocity")
    states = [s.fmu.serializeFMUstate(s.fmu.getFMUstate()) for s in (asked, plain)]
    assert states[0] == states[1]
    asked.close()
    plain.close()


def by_motion(slave, name: str) -> np.ndarray:
    """Rows: components of the force, columns: components of an input."""
    force = [slave.references[f"force.top[{i}]"].valueReference for i in (1, 2, 3)]
    known = [slave.references[f"{name}[{i}]"].valueReference for i in (1, 2, 3)]
    columns = [slave.fmu.getDirectionalDerivative(force, [k], [1.0]) for k in known]
    return np.array(columns).T


@pytest.mark.parametrize(
    ("how", "name", "dt"),
    [
        (1, "vessel.velocity", 0.1),
        (2, "vessel.position", 0.5),
        (3, "vessel.position", 0.5),
    ],
)
@pytest.mark.parametrize("timing", [1, 2])
def test_the_force_by_the_motion_of_the_last_step(taut, how, name, dt, timing):
    """Against steps that are made again with another value: along the line within a tenth, where it
    is the line's stiffness; across, where a step has the inertia of the line, within half."""
    slave = Slave(*taut, **{"vessel.input": how, "input.timing": timing})
    place, speed = np.zeros(3), np.zeros(3)
    for n in range(1, 40):
        place = place + 0.5 * dt * speed
        speed = np.array([0.1 * np.sin(n * dt), 0.02, 0.05 * np.sin(n * dt)])
        place = place + 0.5 * dt * speed
        slave.set("vessel.velocity", speed)
        slave.set("vessel.position", place)
        state = slave.fmu.getFMUstate()
        slave.step(dt)
    found = by_motion(slave, name)
    small = 1e-4
    again = []
    for i in range(3):
        sides = []
        for side in (-small, small):
            slave.fmu.setFMUstate(state)
            slave.time = 38 * dt
            value = (speed if name == "vessel.velocity" else place) + side * np.eye(3)[i]
            slave.set(name, value)
            slave.step(dt)
            sides.append(slave.get("force.top"))
        again.append((sides[1] - sides[0]) / (2 * small))
    again = np.array(again).T
    assert again[0, 0] < -400.0
    assert found[0, 0] == pytest.approx(again[0, 0], rel=0.1)
    told = [text for _, text in slave.messages if "elsewhere drive by velocity" in text]
    assert len(told) == (how != 1)  # once
    if how == 1:
        np.testing.assert_allclose(np.diag(found), np.diag(again), rtol=0.5)
    slave.close()


def test_directions_add_up(taut):
    slave = Slave(*taut)
    drive(slave, 10, 0.1)
    force = [slave.references["force.top[1]"].valueReference]
    known = [slave.references[f"vessel.velocity[{i}]"].valueReference for i in (1, 2, 3)]
    both = slave.fmu.getDirectionalDerivative(force, known, [0.5, -1.0, 2.0])
    row = by_motion(slave, "vessel.velocity")[0]
    np.testing.assert_allclose(both, row @ [0.5, -1.0, 2.0], rtol=1e-6)
    slave.close()


def test_what_has_no_derivatives(taut):
    slave = Slave(*taut)
    fmu, reference = slave.fmu, {n: v.valueReference for n, v in slave.references.items()}
    force, speed = [reference["force.top[1]"]], [reference["vessel.velocity[1]"]]
    assert rates(slave).tolist() == [0.0] * 4  # at rest
    for words, call, arguments in (
        ("before the first step", fmu.getDirectionalDerivative, (force, speed, [1.0])),
        ("order 2, not 1", fmu.getRealOutputDerivatives, (force, [2])),
        ("force.top and tension.top", fmu.getRealOutputDerivatives,
         ([reference["end.position[1]"]], [1])),
        ("vessel.velocity and vessel.position", fmu.getDirectionalDerivative,
         (force, [reference["payout.rate"]], [1.0])),
        ("not finite", fmu.getDirectionalDerivative, (force, speed, [float("nan")])),
    ):  # fmt: skip
        slave.messages.clear()
        with pytest.raises(FMICallException):
            call(*arguments)
        assert words in slave.messages[0][1]
    slave.step(0.1)
    with pytest.raises(FMICallException):
        fmu.getDirectionalDerivative([reference["end.position[1]"]], speed, [1.0])
    assert "force.top and tension.top" in slave.messages[-1][1]
    slave.close()


def test_the_description_says_what_there_is(tmp_path, taut):
    from cablemodel_fmu.export import export_fmu

    text = (taut[0] / "modelDescription.xml").read_text(encoding="utf-8")
    assert 'maxOutputDerivativeOrder="1"' in text
    assert 'providesDirectionalDerivative="true"' in text
    direct = still_scene(solver={"method": "direct_integration"}, payout={})
    export_fmu(direct, tmp_path / "direct.fmu", platforms=["linux64"])
    from fmpy import read_model_description

    found = read_model_description(str(tmp_path / "direct.fmu")).coSimulation
    assert (found.maxOutputDerivativeOrder, found.providesDirectionalDerivative) == (0, False)
