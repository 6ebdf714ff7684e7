"""Who follows whom and where everybody drives, against tables made by hand."""

from dataclasses import replace

import pytest

from cosim.errors import CosimError
from cosim.scenario.settings import chosen
from scenarios.formation import ADAPTIVE
from scenarios.formation.law import Law
from scenarios.formation.settings import formation_settings
from scenarios.formation.start import starts
from scenarios.formation.system import formation_system
from scenarios.formation.timetable import Formation, Transition, arranged
from scenarios.formation.topology import SHAPES, TOPOLOGIES, Spacing, offsets, places, topology

SEVEN = {
    "chain": {2: 1, 3: 2, 4: 3, 5: 4, 6: 5, 7: 6},
    "star": {2: 1, 3: 1, 4: 1, 5: 1, 6: 1, 7: 1},
    "v": {2: 1, 3: 1, 4: 2, 5: 3, 6: 4, 7: 5},
    "diamond": {2: 1, 3: 1, 4: 1, 5: 4, 6: 4, 7: 4},
}
# With ranks of 10 m and files of 3 m.
PLACES = {
    "line": [(0, 0), (-10, 0), (-20, 0), (-30, 0), (-40, 0), (-50, 0), (-60, 0)],
    "v": [(0, 0), (-10, 3), (-10, -3), (-20, 6), (-20, -6), (-30, 9), (-30, -9)],
    "diamond": [(0, 0), (-10, 3), (-10, -3), (-20, 0), (-30, 3), (-30, -3), (-40, 0)],
    "left-wedge": [(0, 0), (-10, 3), (-20, 6), (-30, 9), (-40, 12), (-50, 15), (-60, 18)],
    "right-wedge": [(0, 0), (-10, -3), (-20, -6), (-30, -9), (-40, -12), (-50, -15), (-60, -18)],
}
OFFSETS = {
    "chain": [(-10, 0)] * 6,
    "star": [(-10, 0), (-20, 0), (-30, 0), (-40, 0), (-50, 0), (-60, 0)],
    "v": [(-10, 3), (-10, -3), (-10, 3), (-10, -3), (-10, 3), (-10, -3)],
    "diamond": [(-10, 3), (-10, -3), (-20, 0)] * 2,
}
ROOM = Spacing(10.0, 3.0)
SETTINGS = {name: setting.default for name, setting in formation_settings(4, "chain").items()}


@pytest.mark.parametrize("size", range(1, 8))
@pytest.mark.parametrize("kind", SEVEN)
def test_everybody_follows_whom_the_table_says(kind, size):
    assert topology(kind).leaders(size) == {k: leader for k, leader in SEVEN[kind].items() if k <= size}


@pytest.mark.parametrize("size", range(1, 8))
@pytest.mark.parametrize("shape", PLACES)
def test_everybody_drives_where_the_table_says(shape, size):
    assert places(shape, size, ROOM) == {k: PLACES[shape][k - 1] for k in range(1, size + 1)}


@pytest.mark.parametrize("kind", OFFSETS)
def test_offsets_are_seen_from_the_own_leader(kind):
    wanted = places(topology(kind).shape, 7, ROOM)
    assert list(offsets(topology(kind).leaders(7), wanted).values()) == OFFSETS[kind]


def test_the_tables_are_of_all_there_are():
    assert (SEVEN.keys(), PLACES.keys()) == (TOPOLOGIES.keys(), SHAPES.keys())


@pytest.mark.parametrize("kind", TOPOLOGIES)
def test_a_hundred_cars_have_a_hundred_places_and_follow_cars_before_them(kind):
    assert len(set(places(topology(kind).shape, 100, ROOM).values())) == 100
    assert all(leader < k for k, leader in topology(kind).leaders(100).items())


def settings(size, kind="chain", frame="neighbour"):
    room = {"spacing": ROOM.along, "lateral_spacing": ROOM.across}
    return SETTINGS | room | {"plant": "unicycle", "vehicles": size, "topology": kind, "frame": frame}


def system(formation):
    return formation_system(Law("Follower"), {}, settings(len(formation.cars)), formation)


def test_a_change_of_shape_keeps_who_follows_whom():
    formation = arranged([(15.0, "line")], settings(7, "diamond"))
    (change,) = formation.timetable
    assert formation.leaders == SEVEN["diamond"]
    assert list(formation.offsets.values()) == OFFSETS["diamond"]
    assert change.time == 15.0
    assert change.offsets == {2: (-10, 0), 3: (-20, 0), 4: (-30, 0), 5: (-10, 0), 6: (-20, 0), 7: (-30, 0)}


@pytest.mark.parametrize("kind", SEVEN)
def test_seen_from_the_head_all_follow_it_in_the_same_shape(kind):
    formation = arranged([(15.0, "line")], settings(7, kind, "head"))
    assert formation.trailing
    assert formation.leaders == SEVEN["star"]
    assert formation.offsets == {k: PLACES[topology(kind).shape][k - 1] for k in range(2, 8)}
    assert formation.timetable[0].offsets == {k: (-10.0 * (k - 1), 0.0) for k in range(2, 8)}


@pytest.mark.parametrize(("size", "duration"), [(2, 6.0), (4, 6.79), (13, 15.0), (25, 30.0), (50, 61.25)])
def test_all_take_as_long_for_a_change_as_the_longest_way_needs(size, duration):
    """From a line to a left wedge the last car moves by 4 m per rank, at 6 m/s and 1.5 m/s2 at most."""
    shapes = [(15.0, "line"), (30.0, "left-wedge")]
    room = {"spacing": 10.0, "lateral_spacing": 4.0}
    assert arranged(shapes, settings(size, "diamond", "head") | room).duration == pytest.approx(duration, abs=0.01)


@pytest.mark.parametrize(("kind", "row"), [("chain", True), ("star", True), ("v", False), ("diamond", False)])
def test_chain_and_star_are_rows(kind, row):
    assert arranged((), settings(4, kind)).in_a_row == row


def test_one_car_has_no_follower():
    alone = system(arranged((), settings(1)))
    assert list(alone.instances) == [f"car1.{n}" for n in ("reference", "hlc", "plant", "imu", "gps", "filter")]


def test_the_timetable_moves_the_followers_it_names():
    formation = replace(arranged((), settings(3)), timetable=[Transition(2.0, {3: (-15.0, 1.0)})])
    assert [(e.time, e.signal, e.value) for e in system(formation).events] == [
        (2.0, "car3.follower.formation.x", -15.0),
        (2.0, "car3.follower.formation.y", 1.0),
    ]


def test_starts_follow_what_is_set_of_the_followers(configured):
    light = ("scenario.plant=unicycle", "scenario.vehicles=3", "scenario.topology=chain", "scenario.headway=0.5")
    light = (*light, "scenario.frame=neighbour")
    changed = configured("formation-adaptive", *light, "car2.follower.formation.y=2")
    assert starts(changed, {2: 1, 3: 2}, 20.0) == {2: (-20.0, 2.0), 3: (-40.0, 2.0)}
    with pytest.raises(CosimError, match=r"car3\.follower\.formation\.x = far is not a number"):
        configured("formation-adaptive", *light, "car3.follower.formation.x=far")


@pytest.mark.parametrize("car", [1, 9])
def test_only_followers_change_their_places(car):
    with pytest.raises(CosimError, match=rf"car {car} follows nobody in this formation .* at 2 s"):
        replace(arranged((), settings(3)), timetable=[Transition(2.0, {car: (0.0, 0.0)})])
    with pytest.raises(CosimError, match=rf"car {car} follows nobody in this formation .* at 0 s"):
        Formation({2: 1}, {2: (-10.0, 0.0), car: (0.0, 0.0)})


def test_what_there_is_none_of_is_said():
    with pytest.raises(CosimError, match="unknown topology 'ring'; known are chain, diamond, star, v"):
        arranged((), settings(3, "ring"))
    with pytest.raises(CosimError, match="unknown shape of a formation 'circle'"):
        arranged([(1.0, "circle")], settings(3))


@pytest.mark.parametrize(
    ("assignment", "sentence"),
    [
        (("scenario.vehicles", "0"), r"scenario\.vehicles = 0 is outside its range 1 \.\.\. 100"),
        (("scenario.vehicles", "2.5"), r"scenario\.vehicles = '2\.5' is not a whole number; give one in 1 \.\.\. 100"),
        (("scenario.topology", "ring"), r"scenario\.topology = 'ring' is not one of chain, star, v, diamond"),
        (("scenario.plant", "tank"), r"scenario\.plant = 'tank' is not one of 16dof, double-track, unicycle"),
        (("scenario.vehicle", "3"), r"did you mean vehicles"),
    ],
)
def test_bad_settings_are_one_sentence(assignment, sentence):
    with pytest.raises(CosimError, match=sentence):
        chosen(ADAPTIVE.name, ADAPTIVE.settings, [assignment])
