"""Wiring and values: everything a user can get wrong is one sentence that names it."""

import pytest
from cosim_mocks import RADIAN, UNITS, assembled, face

from cosim.errors import CosimError
from cosim.model.assembly import derived_seed, leave_out
from cosim.model.face import Face, Port
from cosim.model.parsing import parse_assignments
from cosim.model.patterns import matches
from cosim.model.system import System
from cosim.model.units import Unit, conversion

GAIN = Port("gain", 0, "parameter", unit="s", minimum=0.0, maximum=5.0)
SWITCH = Port("active", 0, "parameter", "Boolean")
SEED = Port("seed", 0, "parameter", "Integer", minimum=0, maximum=2**31 - 1)
MODE = Port("mode", 0, "parameter", "Enumeration", items=(("comfort", 1), ("sport", 3)))
FAULT = Port("fault", 0, "output", "Boolean")


def pair(source: Face, target: Face, names=None):
    system = System()
    system.add("source", "Mock")
    system.add("target", "Mock")
    system.connect("source", "target", names)
    return assembled(system, {"source": source, "target": target}, 0)


def single(parameters, period=None, extra=(GAIN, SWITCH, SEED, MODE)):
    system = System()
    system.add("car1.llc", "Mock", period=period)
    for name, value in parameters.items():
        system.set(name, value)
    return assembled(system, {"car1.llc": face({"u": "m"}, {"y": "m"}, extra=extra)}, 7)["car1.llc"]


def test_same_name_to_same_name():
    nodes = pair(face({}, {"a": "m", "b": "m"}), face({"b": "m", "c": "m"}, {}))
    assert [c.text for c in nodes["target"].incoming.values()] == ["source.b -> target.b"]


def test_prefixes_and_single_names():
    source = face({}, {"yaw": "rad", "rate.z": "rad", "estimate.yaw": "rad"})
    target = face({"estimate.yaw": "rad", "estimate.yaw_rate": "rad"}, {})
    nodes = pair(source, target, {"estimate.": "", "estimate.yaw_rate": "rate.z"})
    assert {c.input: c.output for c in nodes["target"].incoming.values()} == {
        "estimate.yaw": "yaw",
        "estimate.yaw_rate": "rate.z",
    }


@pytest.mark.parametrize(
    ("source", "target", "names", "sentence"),
    [
        (face({}, {"a": "m"}), face({"a": "s"}, {}), None, "source.a -> target.a: the units m and s do not measure"),
        (face({}, {"a": "m"}), face({"a": "furlong"}, {}), None, "cannot relate the units m and furlong"),
        (face({}, {"a": "m"}), face({"b": "m"}, {}), None, "nothing connects source to target"),
        (face({}, {"speed": "m"}), face({"b": "m"}, {}), {"b": "sped"}, "unknown output of source .* speed"),
        (face({}, {"a": "m"}), face({"speed": "m"}, {}), {"sped": "a"}, "unknown input of target .* speed"),
        (
            face({}, {"a": "m"}, extra=(FAULT,)),
            face({"fault": "m"}, {}),
            None,
            "one is Boolean, the other Real; connect ports of one type",
        ),
    ],
)
def test_bad_connections(source, target, names, sentence):
    with pytest.raises(CosimError, match=sentence):
        pair(source, target, names)


def test_an_input_is_fed_once_and_not_set_as_well():
    system = System()
    for name in ("a", "b", "sink"):
        system.add(name, "Mock")
    system.connect("a", "sink")
    faces = {"a": face({}, {"x": "m"}), "b": face({}, {"x": "m"}), "sink": face({"x": "m"}, {})}
    system.set("sink.x", 3.0)
    with pytest.raises(CosimError, match=r"sink\.x cannot be set, as it is connected: a\.x -> sink\.x"):
        assembled(system, faces, 0)
    system.connect("b", "sink")
    with pytest.raises(CosimError, match="is fed twice"):
        assembled(system, faces, 0)


@pytest.mark.parametrize(
    ("setting", "sentence"),
    [
        ({"car1.llc.gain": "6"}, r"car1\.llc\.gain = 6 s is outside its range 0 \.\.\. 5 s"),
        ({"car1.llc.gain": "nan"}, "is not a finite number"),
        ({"car1.llc.gain": "fast"}, "car1.llc.gain = fast is not a number"),
        ({"car1.llc.gian": "1"}, r"unknown variable of car1\.llc \(Mock\) 'gian'; did you mean gain"),
        ({"car1.llc.active": "maybe"}, "is not a Boolean; write true or false"),
        ({"car1.llc.seed": "1.5"}, "is not a whole number"),
        ({"car1.llc.seed": "inf"}, "is not a whole number"),
        ({"car1.llc.seed": "2147483648"}, r"= 2147483648 is outside its range 0 \.\.\. 2147483647"),
        ({"car1.llc.seed": "4294967297"}, "is outside its range"),
        ({"car1.llc.seed": "9" * 40}, "is too large for any Integer"),
        ({"car1.llc.mode": "sports"}, r"mode = sports is none of comfort \(1\), sport \(3\)"),
        ({"car1.llc.mode": "2"}, r"is none of comfort \(1\), sport \(3\)"),
        ({"car1.llc.y": "1"}, r"car1\.llc\.y is an output"),
        ({"car2.llc.gain": "1"}, "unknown instance"),
    ],
)
def test_bad_values(setting, sentence):
    with pytest.raises(CosimError, match=sentence):
        single(setting)


def test_values_take_the_type_of_their_port():
    node = single({"car1.llc.gain": "2", "car1.llc.active": "off", "car1.llc.u": "-1"})
    assert node.values == {"gain": 2.0, "active": False, "u": -1.0, "seed": derived_seed(7, "car1.llc")}


def test_whole_numbers_and_items_in_any_spelling():
    for text, value in {"3.0": 3, "1e2": 100, "-0": 0, "+7": 7}.items():
        assert single({"car1.llc.seed": text}).values["seed"] == value
    assert [single({"car1.llc.mode": text}).values["mode"] for text in ("sport", "3", 1)] == [3, 3, 1]


def test_seeds_differ_by_instance_and_run_and_can_be_set():
    assert single({"car1.llc.seed": "5"}).values["seed"] == 5
    seeds = {derived_seed(run, name) for run in range(5) for name in ("imu", "gps", "car1.imu")}
    assert len(seeds) == 15
    assert derived_seed(0, "imu") == 835407668, "seeds must be the same on every machine and for ever"
    assert all(0 <= seed < 2**31 for seed in seeds)


def test_the_period_reaches_the_sampling_grid_and_back():
    sample_period = Port("sample_period", 0, "parameter", unit="s", minimum=1e-6, maximum=1e3)
    overridden = single({}, period=0.05, extra=(sample_period,))
    assert (overridden.period, overridden.values["sample_period"]) == (50_000_000, 0.05)
    assert single({"car1.llc.sample_period": "0.04"}, extra=(sample_period,)).period == 40_000_000


def test_a_period_of_no_whole_nanoseconds_names_the_instance():
    with pytest.raises(CosimError, match=r"the period of car1\.llc \(Mock\) is 0.333"):
        single({}, period=1 / 3)


def test_conversion_of_angles_and_temperatures():
    degrees = conversion(UNITS["deg"], RADIAN, "x")
    assert degrees.factor * 180.0 == pytest.approx(3.141592653589793)
    fahrenheit = Unit("degF", UNITS["K"].exponents, 5.0 / 9.0, 273.15 - 32.0 * 5.0 / 9.0)
    to_celsius = conversion(fahrenheit, UNITS["degC"], "x")
    assert to_celsius.factor * 212.0 + to_celsius.offset == pytest.approx(100.0)
    assert conversion(None, UNITS["m"], "x").trivial


@pytest.mark.parametrize("text", ["amplitude=3", "hlc.x", "=3"])
def test_unreadable_assignments(text):
    with pytest.raises(CosimError, match=r"write --set instance\.variable=value"):
        parse_assignments([text])


def cars(*names):
    system = System()
    for name in names:
        system.add(name, "Mock")
    return system


def given(system, variable):
    """What instances were told of `variable`, which all of them have."""
    faces = {name: face({variable: "m"}) for name in system.instances}
    nodes = assembled(system, faces)
    return {name: node.values[variable] for name, node in nodes.items() if variable in node.values}


def test_a_pattern_sets_every_instance_it_fits():
    system = cars("car1.llc", "car2.llc", "car2.plant", "car10.llc", "car1")
    system.set("car*.llc.filter.speed", 40)
    assert given(system, "filter.speed") == {"car1.llc": 40, "car2.llc": 40, "car10.llc": 40}
    system = cars("car1.llc", "car2.llc", "car2.plant", "car10.llc", "car1")
    system.set("car?.llc.gain", 1)
    assert given(system, "gain") == {"car1.llc": 1, "car2.llc": 1}
    system.set("car2.*.gain", 2)
    assert given(system, "gain") == {"car1.llc": 1, "car2.llc": 2, "car2.plant": 2}


def test_two_stars_stand_for_dots_too_and_brackets_for_themselves():
    system = cars("car1.llc", "car2.plant", "tank")
    system.set("**.gain", 3)
    assert given(system, "gain") == {"car1.llc": 3, "car2.plant": 3, "tank": 3}
    assert matches("a.preview[3].x", "a.*[3].x")
    assert not matches("a.preview3.x", "a.*[3].x")
    assert not matches("a.b.c.x", "a.*.x")


def test_the_later_of_a_pattern_and_a_name_counts():
    for signals, expected in ((("car*.llc.gain", "car2.llc.gain"), 2), (("car2.llc.gain", "car*.llc.gain"), 2)):
        system = cars("car1.llc", "car2.llc")
        for value, signal in enumerate(signals, start=1):
            system.set(signal, value)
        assert given(system, "gain")["car2.llc"] == expected


def test_a_name_is_no_pattern():
    system = cars("tank*", "tanks")
    system.set("tank*.level", 1)
    assert given(system, "level") == {"tank*": 1}


@pytest.mark.parametrize("pattern", ["bus*.llc.gain", "car*.llc", "car*.llc.speed", "*"])
def test_a_pattern_that_fits_nothing_is_said(pattern):
    system = cars("car1.plant.wheel", "car1.llc.left")
    system.set(pattern, 1)
    with pytest.raises(CosimError, match=r"no instance fits the pattern .* as in car\*\.llc\.filter\.speed"):
        given(system, "gain")


def with_gain(*names, of=("gain",)):
    """Faces with inputs `of` for instances of these names, and without for all others."""
    return lambda system: {name: face(dict.fromkeys(of, "m") if name in names else {}) for name in system.instances}


def test_a_pattern_passes_over_instances_without_the_variable():
    system = cars("car1.llc", "car2.llc", "car2.plant")
    system.set("car*.*.gain", 1)
    nodes = assembled(system, with_gain("car1.llc", "car2.plant")(system), 0)
    assert {name: node.values for name, node in nodes.items()} == {
        "car1.llc": {"gain": 1.0},
        "car2.llc": {},
        "car2.plant": {"gain": 1.0},
    }
    with pytest.raises(CosimError, match=r"variable of the instances that fit 'car\*\.\*\.gain' 'gain'; .*mean gains"):
        assembled(system, with_gain("car1.llc", of=("gains",))(system), 0)


@pytest.mark.parametrize("order", [1, -1])
def test_a_name_beside_a_pattern_must_have_the_variable(order):
    system = cars("car1.llc", "car2.llc")
    for assignment in ("car2.llc.gain", "car*.llc.gain")[::order]:
        system.set(assignment, 1)
    with pytest.raises(CosimError, match=r"unknown variable of car2\.llc \(Mock\) 'gain'"):
        assembled(system, with_gain("car1.llc")(system), 0)


def test_an_unknown_instance_is_named_with_its_dots():
    system = cars("car1.llc", "car2.follower", "car3.follower")
    with pytest.raises(
        CosimError, match=r"unknown instance 'car1\.follower'; did you mean car3\.follower or car2\.fol"
    ):
        system.set("car1.follower.formation.x", 1)
    with pytest.raises(CosimError, match=r"unknown instance 'car1'; did you mean car1\.llc"):
        system.set("car1.gain", 1)


def test_what_nothing_reads_can_be_left_out():
    system = System()
    system.add("car1", "Mock")
    system.add("car2", "Mock")
    system.connect("car1", "car2", {"x": "wheel.fl"})
    faces = dict.fromkeys(("car1", "car2"), face({"x": "m"}, {"wheel.fl": "m", "wheel.fr": "m", "y": "m"}))
    nodes = assembled(system, faces, 0)
    leave_out(nodes, ["**.f?", "car2.y"])
    assert nodes["car1"].outputs == ("wheel.fl", "y"), "the one that is read stays"
    assert nodes["car2"].outputs == ()
