"""The values a system starts with: set, derived, or brought by a model; and mistakes in the words of the user."""

import pytest
from cosim_mocks import face

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from cosim.model.face import Port
from cosim.model.system import System

SPEED = Port("filter.speed", 0, "parameter", unit="rad/s", minimum=1.0, maximum=100.0, start=20.0)
ASSUMED = Port("actuator.speed", 0, "parameter", unit="rad/s", minimum=15.0, maximum=1e6, start=30.0)
FILE = Port("file", 0, "parameter", "String", start="")
COUNT = Port("count", 0, "parameter", "Integer", start=3)


def configured(*assignments, parameters=None):
    """Two controllers, of which `hlc` assumes something of `llc`."""
    system = System()
    system.add("hlc", "High", parameters)
    system.add("llc", "Low", period=0.02)
    for signal, value in assignments:
        system.set(signal, value)
    grid = Port("sample_period", 0, "parameter", unit="s", minimum=1e-6, maximum=1.0, start=0.001)
    faces = {"hlc": face(extra=(ASSUMED, FILE, COUNT)), "llc": face({"u": "m"}, {"y": "m"}, extra=(SPEED, grid))}
    return Configuration(system, faces)


def test_what_is_set_counts_before_what_is_derived_and_that_before_the_start_value():
    made = configured(("hlc.actuator.speed", "50"))
    made.default("hlc", "actuator.speed", 40.0)
    made.default("llc", "filter.speed", 40.0)
    made.default("llc", "filter.speed", 60.0)
    assert (made.value("hlc", "actuator.speed"), made.value("llc", "filter.speed")) == (50.0, 40.0)
    assert (made.value("hlc", "count"), made.value("hlc", "file")) == (3, "")
    assert made.changed("hlc") == {"actuator.speed": 50.0}
    assert made.values("hlc") == {"actuator.speed": 50.0, "file": "", "count": 3}


def test_the_users_value_overrules_that_of_the_scenario():
    assert configured(parameters={"count": "5"}).value("hlc", "count") == 5
    assert configured(("h*.count", "6"), parameters={"count": 5}).value("hlc", "count") == 6


def test_a_value_can_follow_another():
    made = configured(("llc.filter.speed", "25"))
    made.follow("hlc", "actuator.speed", "llc.filter.speed")
    assert made.number("hlc", "actuator.speed") == 25.0


def test_what_follows_and_is_the_start_value_anyway_is_not_set():
    made = configured(("llc.filter.speed", "30"))
    made.follow("hlc", "actuator.speed", "llc.filter.speed")
    assert made.changed("hlc") == {}


@pytest.mark.parametrize("pattern", ["h**t", "hlc.*t", "hlc.c?unt"])
def test_a_pattern_may_stand_for_the_variable_too(pattern):
    assert configured((pattern, "9")).value("hlc", "count") == 9


def test_a_text_is_no_number():
    with pytest.raises(CosimError, match=r"^hlc\.file is a text, not a number$"):
        configured().number("hlc", "file")


def test_what_follows_and_does_not_fit_names_what_was_set():
    made = configured(("llc.filter.speed", "5"))
    with pytest.raises(CosimError) as error:
        made.follow("hlc", "actuator.speed", "llc.filter.speed")
    assert str(error.value) == (
        "llc.filter.speed = 5 does not fit, because hlc.actuator.speed = 5 rad/s is outside its range "
        "15 ... 1e+06 rad/s and follows from it; give it another value, or set hlc.actuator.speed as well"
    )


@pytest.mark.parametrize(
    ("signal", "value", "sentence"),
    [
        ("l*.filter.speed", "fast", r"^l\*\.filter\.speed = fast is not a number$"),
        ("*.filter.speed", "1000", r"^\*\.filter\.speed = 1000 rad/s is outside its range 1 \.\.\. 100 rad/s$"),
        ("llc.y", "1", r"^llc\.y is an output of Mock and cannot be set$"),
        ("llc.z", "1", r"^unknown variable of llc \(Mock\) 'z'; known are filter\.speed, sample_period, u$"),
    ],
)
def test_mistakes_are_in_the_words_of_the_user(signal, value, sentence):
    with pytest.raises(CosimError, match=sentence):
        configured((signal, value))


@pytest.mark.parametrize("number", [float("inf"), "inf", "9" * 400, 10**400])
def test_a_count_beyond_all_numbers_is_a_mistake(number):
    with pytest.raises(CosimError, match=r"^hlc\.count = \w+ is (not a whole number|too large for any Integer)$"):
        configured(("hlc.count", number))


@pytest.mark.parametrize("pattern", ["h**", "h**t", "**count", "*.c*t", "???.count"])
def test_two_stars_may_hold_the_dot_after_an_instance(pattern):
    assert configured((pattern, "20")).value("hlc", "count") == 20


def test_an_event_beyond_all_nanoseconds_is_a_mistake():
    with pytest.raises(CosimError, match=r"^llc\.u cannot be set at 1e\+300 s; give a time from 0 to"):
        configured().system.at(1e300, "llc.u", 1.0)


def test_a_period_is_told_to_the_sampling_grid_unless_that_is_set():
    assert configured().value("llc", "sample_period") == 0.02
    assert configured(("llc.sample_period", 0.01)).value("llc", "sample_period") == 0.01


def test_a_value_nobody_knows():
    made = configured()
    with pytest.raises(CosimError, match=r"^llc\.u has no start value; set it$"):
        made.value("llc", "u")
