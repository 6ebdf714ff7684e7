"""The scheme of most other tools: all due slaves take their inputs, then all step, then their outputs appear."""

from itertools import pairwise

import pytest
from cosim_mocks import Mock, assembled, face, faces_of, plan_of, simulate

from cosim.command.explain import explanation
from cosim.engine.schedule import schedule
from cosim.errors import CosimError
from cosim.model.system import System


def loop(*, slow=0.02):
    """A sampled source of period `slow`, a sampled follower and a plant of 10 ms, in a ring."""
    system = System()
    source = Mock(face({"y": "m"}, {"a": "m"}, step=slow), lambda t, h, u: {"a": u["y"] + 1.0}, {"a": -1.0})
    follower = Mock(face({"a": "m"}, {"b": "m"}, step=0.01), lambda t, h, u: {"b": 10.0 * u["a"]}, {"b": -10.0})
    plant = Mock(face({"b": "m"}, {"y": "m"}, step=0.01, continuous=True), lambda t, h, u: {"y": u["b"] + 0.5})
    mocks = {"source": source, "follower": follower, "plant": plant}
    for name in mocks:
        system.add(name, "Mock")
    system.connect("source", "follower")
    system.connect("follower", "plant")
    system.connect("plant", "source")
    return system, mocks


def test_every_edge_is_a_delay_of_its_sources_period():
    system, mocks = loop()
    outcome, rows = simulate(system, mocks, 0.05, "jacobi")
    assert outcome.status == "ok"
    assert [(t, h) for t, h, _ in mocks["source"].steps] == [(0.0, 0.02), (0.02, 0.02), (0.04, pytest.approx(0.01))]
    assert [row["time"] for row in rows] == [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]
    assert [row["source.a"] for row in rows] == [-1, -1, 1, 1, -8.5, 11.5]
    assert [row["follower.b"] for row in rows] == [-10, -10, -10, 10, 10, -85]
    assert [row["plant.y"] for row in rows] == [0, -9.5, -9.5, -9.5, 10.5, 10.5]


def test_inputs_are_those_of_the_tick_whatever_the_order():
    """Gathering, stepping and publishing one slave after the other would let the later ones see the earlier."""
    for names in (("source", "follower", "plant"), ("plant", "follower", "source")):
        system, mocks = loop(slow=0.01)
        system.instances = {name: system.instances[name] for name in names}
        _, rows = simulate(system, mocks, 0.03, "jacobi")
        for before, after in pairwise(rows):
            assert after["source.a"] == before["plant.y"] + 1.0
            assert after["follower.b"] == 10.0 * before["source.a"]
            assert after["plant.y"] == before["follower.b"] + 0.5


def test_initial_values_still_follow_the_dataflow():
    system, mocks = loop()
    simulate(system, mocks, 0.01, "jacobi")
    assert mocks["plant"].steps[0][2] == {"b": -10.0}
    nodes = assembled(system, faces_of(mocks))
    assert schedule(nodes, "jacobi").initial == schedule(nodes).initial == ("plant", "source", "follower")


def test_one_step_for_all():
    system, mocks = loop()
    simulate(system, mocks, 0.02, "jacobi", step=0.005)
    assert all([(t, h) for t, h, _ in mock.steps] == [(k * 0.005, 0.005) for k in range(4)] for mock in mocks.values())
    with pytest.raises(CosimError, match="the common step is 0 s; it must be positive"):
        assembled(system, faces_of(mocks), step=0.0)


def test_explain_shows_that_all_step_together():
    system, mocks = loop()
    tables = dict(explanation(plan_of(system, mocks, scheme="jacobi")))
    assert set(tables["edges"].columns[3].cells) == {"delay: the value at the communication point, held over the step"}
    order = next(table for title, table in tables.items() if title.startswith("mocked: order"))
    assert list(order.columns[0].cells) == ["then, together"] * 3
