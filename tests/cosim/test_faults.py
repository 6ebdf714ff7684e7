"""Faults of signals: their values at every exchange, in both schemes, against what their definitions give."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import Mock, face, simulate

from cosim.errors import CosimError
from cosim.model.effects import Delay, Drop, Effect, Freeze, Linear, Noise, Override, Ramp, Table
from cosim.model.face import Port
from cosim.model.fault import Fault, comparisons
from cosim.model.system import System
from cosim.system_file.events import add_events, add_events_of
from cosim.system_file.writing import fault_form

STEP = 0.1


def clocked(*faults: Fault, scheme: str = "multirate", at: tuple[float, str, float] | None = None, plant: bool = False):
    """Rows of a clock whose time a meter shows, with faults on its way."""
    mocks = {
        "clock": Mock(face(outputs={"t": "s"}, step=STEP), lambda time, _length, _held: {"t": time}),
        "meter": Mock(
            face({"t": "s", "free": "m"}, {"seen": "s", "free_seen": "m"}, step=STEP, continuous=plant),
            lambda _time, _length, held: {"seen": held["t"], "free_seen": held.get("free", 0.0)},
        ),
    }
    system = System()
    system.add("clock", "Mock")
    system.add("meter", "Mock")
    system.connect("clock", "meter")
    for fault in faults:
        system.fail(fault)
    if at is not None:
        system.at(*at)
    outcome, rows = simulate(system, mocks, 1.0, scheme)
    assert outcome.status == "ok", outcome.reason
    return mocks["meter"].steps, {name: np.array([row[name] for row in rows]) for name in rows[0]}


def taken(effect: Effect, begin: float = 0.3, end: float = 0.7, **options: str) -> np.ndarray:
    """What the meter takes at 0, 0.1, ... 0.9 s."""
    steps, rows = clocked(Fault("meter.t", effect, begin, end), **options)
    values = np.array([held["t"] for _, _, held in steps])
    np.testing.assert_array_equal(rows["clock.t"][:10], np.arange(10) / 10)  # before: as it was
    np.testing.assert_array_equal(rows["meter.t"][:10], values)  # after: recorded in the row of its tick
    return values


CLOCK = np.arange(10) / 10
LASTS = (CLOCK >= 0.3) & (CLOCK < 0.7)


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        (Override(5.0), np.where(LASTS, 5.0, CLOCK)),
        (Linear(2.0, 1.0), np.where(LASTS, 2 * CLOCK + 1, CLOCK)),
        (Freeze(), np.where(LASTS, 0.3, CLOCK)),
        (Ramp(1.3, 0.2), np.where(LASTS, np.clip(0.3 + (CLOCK - 0.3) / 0.2, 0.3, 1.3), CLOCK)),
        (Table((0.4, 0.6), (1.0, 3.0)), np.where(LASTS, np.clip(1 + 10 * (CLOCK - 0.4), 1.0, 3.0), CLOCK)),
        (Delay(0.2), np.where(LASTS, np.maximum(CLOCK - 0.2, 0.3), CLOCK)),
        (Drop(1.0), np.where(LASTS, 0.3, CLOCK)),
        (Drop(0.0), CLOCK),
    ],
)
def test_effects(effect: Effect, expected: np.ndarray) -> None:
    np.testing.assert_allclose(taken(effect), expected, atol=1e-12)


def test_a_plant_has_the_fault_in_the_row_of_its_tick() -> None:
    steps, rows = clocked(Fault("meter.t", Override(5.0), 0.3, 0.7), plant=True)
    values = [held["t"] for _, _, held in steps]
    np.testing.assert_array_equal(values, np.where(LASTS, 5.0, CLOCK))
    np.testing.assert_array_equal(rows["meter.t"][:10], values)


def test_noise_is_normal_and_repeatable() -> None:
    """500 values of sigma 2 within four standard errors; the same seed and signal give the same values."""
    mocks = {
        "zero": Mock(face(outputs={"y": "m"}, step=0.001), lambda *_: {"y": 0.0}),
        "taker": Mock(face({"y": "m", "z": "m"}, {"seen": "m"}, step=0.001), lambda *_: {"seen": 0.0}),
    }
    system = System()
    for name in mocks:
        system.add(name, "Mock")
    system.connect("zero", "taker", {"y": "y", "z": "y"})
    system.fail(Fault("taker.*", Noise(2.0)))
    _, rows = simulate(system, mocks, 0.5)
    _, again = simulate(system, mocks, 0.5)
    y, z = (np.array([row[f"taker.{name}"] for row in rows[:-1]]) for name in "yz")
    assert [row["taker.y"] for row in again[:-1]] == y.tolist()
    assert abs(y.mean()) < 4 * 2 / math.sqrt(500) and y.std() == pytest.approx(2.0, rel=4 / math.sqrt(1000))
    assert abs(np.corrcoef(y, z)[0, 1]) < 4 / math.sqrt(500)


@pytest.mark.parametrize("effect", [Freeze(), Drop(1.0), Delay(0.25)])
def test_from_the_beginning_on_it_is_the_first_value_that_stays(effect: Effect) -> None:
    """Not what the output was before anything had been calculated: here a loop whose first value is 7."""
    mocks = {
        "one": Mock(
            face({"b": "m"}, {"a": "m"}, step=STEP), lambda time, _length, _held: {"a": 7.0 + time}, {"a": 7.0}
        ),
        "two": Mock(face({"a": "m"}, {"b": "m"}, step=STEP), lambda _time, _length, held: {"b": held["a"]}),
    }
    system = System()
    system.add("one", "Mock")
    system.add("two", "Mock")
    system.connect("one", "two")
    system.connect("two", "one")
    system.fail(Fault("two.a", effect))
    _, rows = simulate(system, mocks, 0.3)
    assert [row["two.a"] for row in rows[:3]] == [7.0, 7.0, 7.0]


def test_a_value_that_is_offered_again_is_not_dropped_again() -> None:
    """Ten messages, each offered ten times: half of the messages are lost, not half of the offers."""
    arrived = 0
    for seed in range(40):
        act = Drop(0.5).begin(0.0, 0.0, np.random.default_rng(seed))
        seen = {act(0.1 * k, float(1 + k // 10)) for k in range(100)}
        arrived += len(seen - {0.0})
    assert arrived / 400 == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(400))


def test_what_is_recorded_of_whole_numbers_is_what_is_taken() -> None:
    whole = Port("n", 0, "input", "Integer", "discrete")
    switch = Port("b", 0, "input", "Boolean", "discrete")
    taken: list[dict[str, float]] = []

    def note(_time: float, _length: float, held: dict[str, float]) -> dict[str, float]:
        taken.append(dict(held))
        return {"seen": 0.0}

    mocks = {"taker": Mock(face({}, {"seen": "m"}, step=STEP, extra=(whole, switch)), note)}
    system = System()
    system.add("taker", "Mock")
    system.fail(Fault("taker.n", Ramp(10.0, 0.35)))
    system.fail(Fault("taker.b", Override(1.0), 0.2))
    system.fail(Fault("taker.n", Linear(1e12), 0.5))
    _, rows = simulate(system, mocks, 0.8)
    assert [row["taker.n"] for row in rows[:5]] == [0, 3, 6, 9, 10]
    assert rows[6]["taker.n"] == 2**31 - 1
    assert [row["taker.b"] for row in rows[:4]] == [0, 0, 1, 1]
    assert [held["n"] for held in taken] == [row["taker.n"] for row in rows[:-1]]
    for effect in (Noise(1.0), Linear(2.0), Ramp(1.0, 1.0)):
        system.faults = [Fault("taker.b", effect)]
        with pytest.raises(
            CosimError, match=r"taker\.b is Boolean, which can be overridden, frozen, delayed or dropped"
        ):
            simulate(system, mocks, 0.8)


def test_a_pattern_does_not_mean_texts_and_a_condition_may_look_at_inputs_with_events() -> None:
    text = Port("name", 0, "input", "String", "discrete")
    mocks = {"taker": Mock(face({"x": "m"}, {"seen": "m"}, step=STEP, extra=(text,)), lambda *_: {"seen": 0.0})}
    system = System()
    system.add("taker", "Mock")
    system.fail(Fault("taker.*", Ramp(1.0, 1.0)))
    system.fail(Fault("taker.x", Linear(0.0, 5.0), when=comparisons("taker.x > 0.45")))
    _, rows = simulate(system, mocks, 0.8)
    # the condition looks at what was shown a tick before, and by then the ramp is past it
    assert [row["taker.x"] for row in rows[:8]] == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.5, 5.0, 5.0])


def test_dropped_values_are_as_many_as_they_should_be() -> None:
    steps = [_dropping(seed) for seed in range(60)]
    lost = np.mean(steps)
    assert lost == pytest.approx(0.3, abs=4 * math.sqrt(0.3 * 0.7 / (60 * 99)))


def _dropping(seed: int) -> float:
    act = Drop(0.3).begin(0.0, 0.0, np.random.default_rng(seed))
    values = [act(float(k), float(k)) for k in range(1, 100)]
    return float(np.mean(np.array(values) != np.arange(1, 100)))


def test_conditions() -> None:
    """While all hold; an effect that begins again begins anew."""
    when = comparisons("clock.t >= 0.2 and clock.t != 0.5")
    steps, _ = clocked(Fault("meter.t", Freeze(), when=when))
    values = [held["t"] for _, _, held in steps]
    assert values == pytest.approx([0.0, 0.1, 0.2, 0.2, 0.2, 0.5, 0.6, 0.6, 0.6, 0.6])


def test_faults_act_one_after_the_other() -> None:
    steps, _ = clocked(Fault("meter.t", Linear(2.0)), Fault("meter.t", Linear(1.0, 1.0)))
    assert [held["t"] for _, _, held in steps] == pytest.approx(2 * CLOCK + 1)


@pytest.mark.parametrize("scheme", ["multirate", "jacobi"])
@pytest.mark.parametrize("plant", [False, True])
def test_an_override_of_a_free_input_is_what_an_event_sets(scheme: str, plant: bool) -> None:
    _, set_ = clocked(scheme=scheme, at=(0.3, "meter.free", 4.0), plant=plant)
    _, overridden = clocked(Fault("meter.free", Override(4.0), 0.3), scheme=scheme, plant=plant)
    for name in set_:
        if name != "meter.free_seen":  # mocks do not take what events set
            np.testing.assert_array_equal(set_[name], overridden[name], err_msg=name)


def test_faults_written_into_a_system_file_are_read_again(tmp_path: Path) -> None:
    effects = [Override(1.0), Ramp(2.0, 3.0), Table((0.0, 1.0), (2.0, 3.0)), Linear(2.0, 1.0), Noise(0.5), Freeze()]
    when = comparisons("clock.t > 0.25 and clock.t <= 3")
    faults = [Fault("meter.t", effect, 1.0, 2.0, when) for effect in (*effects, Delay(0.1), Drop(0.3))]
    system = System()
    system.add("meter", "Mock")
    add_events(system, [fault_form(fault) for fault in faults], tmp_path / "events.toml")
    assert system.faults == faults


def test_mistakes(tmp_path: Path) -> None:
    def said(text: str) -> None:
        file = tmp_path / "events.toml"
        file.write_text(text)
        system = System()
        system.add("meter", "Mock")
        add_events_of(str(file), system)

    for text, sentence in {
        "[[events]]\ntime = 1.0": "event 1: give set, or a signal and one of",
        '[[events]]\nsignal = "meter.t"': "give set, or a signal and one of",
        '[[events]]\nsignal = "meter.t"\nfreeze = true\ndelay = 1.0': "freeze and delay are two effects",
        '[[events]]\nsignal = "meter.t"\ndelay = -1.0': "delay is -1; give a positive number",
        '[[events]]\nsignal = "meter.t"\nramp_to = 1.0': "over is missing",
        '[[events]]\nsignal = "meter.t"\ndrop = 2.0': "the probability",
        '[[events]]\nsignal = "meter.t"\nbias = 1.0\ntime = 2.0\nuntil = 1.0': "lasts from 2 to 1 s",
        '[[events]]\nsignal = "meter.t"\nbias = 1.0\nwhen = "much"': "cannot read the condition 'much'",
        '[[events]]\nsignal = "metre.t"\nbias = 1.0': "unknown instance .*metre",
        '[[events]]\nsignal = "meter.t"\ntable = "none.csv"': r"none\.csv cannot be read",
        '[[events]]\nsignal = "meter.t"\ntable = [[0.0, 1.0], [0.0, 2.0]]': "table: the times must increase",
        '[[events]]\nsignal = "meter.t"\ntable = [[0.0, 1.0, 2.0]]': "give rows of time and value",
        '[[events]]\nset = {"meter.t" = 1.0}\nuntil = 2.0': "set stands alone",
        '[[events]]\nsignals = "meter.t"': "unknown key `signals`",
    }.items():
        with pytest.raises(CosimError, match=sentence):
            said(text)
    with pytest.raises(CosimError, match=r"unknown events .*gps-outtage"):
        add_events_of("gps-outtage", System())


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        (Fault("meter.seen", Freeze()), "unknown input of meter .*seen"),
        (Fault("meter.t", Freeze(), when=comparisons("clock.x > 1")), "unknown signal of a condition .*clock.x"),
    ],
)
def test_signals_that_are_not_there(fault: Fault, sentence: str) -> None:
    with pytest.raises(CosimError, match=sentence):
        clocked(fault)


def test_set_and_changed_by_two_events() -> None:
    with pytest.raises(CosimError, match=r"meter\.free is set by one event and changed by another"):
        clocked(Fault("meter.free", Freeze()), at=(0.3, "meter.free", 4.0))
