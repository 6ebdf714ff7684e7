"""Authoring: from equations of named symbols to the functions of a kernel."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from fmukit.integration import rk4
from fmukit.interface import continuous, input_, output, parameter, sampled
from fmukit.kernel import (
    Layout,
    Parts,
    Signals,
    block,
    choose,
    continuous_kernel,
    exact_kernel,
    named,
    sampled_kernel,
    slots,
)

PORTS = [
    parameter("rate", "1/s", "rate of the decay", 2.0),
    input_("push.x", "m/s", "push along x"),
    input_("push.y", "m/s", "push along y"),
    output("place.x", "m", "place along x"),
    output("place.y", "m", "place along y"),
]
SAMPLED = sampled("Sampled", "for tests", step=0.1, variables=PORTS)
MOVING = continuous("Moving", "for tests", step=0.1, max_substep=0.1, variables=PORTS)
PAIR = Layout(a=1, b=2)
STATES = Layout(place=2, pair=PAIR)


def numbers(column: ca.DM) -> list[float]:
    return list(column.full().ravel())


def test_a_nested_layout_is_split_and_joined() -> None:
    column = ca.DM([1, 2, 3, 4, 5])
    parts = STATES.split(column)
    assert (STATES.size, STATES.sizes) == (5, {"place": 2, "pair": 3})
    assert float(parts["pair"]["a"]) == 3.0
    assert numbers(STATES.join(parts)) == [1, 2, 3, 4, 5]
    assert numbers(STATES.join(parts | {"pair": column[2:]})) == [1, 2, 3, 4, 5]
    assert numbers(STATES.begun({"place": column[:2]})) == [1, 2, 0, 0, 0]


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"place": ca.DM.zeros(2)}, r"unknown values \[\], missing values \['pair'\]"),
        ({"place": ca.DM.zeros(2), "pair": ca.DM.zeros(3), "more": 1}, r"unknown values \['more'\]"),
        ({"place": ca.DM.zeros(3), "pair": ca.DM.zeros(3)}, "place has 3 elements, not 2"),
        ({"place": ca.DM.zeros(2), "pair": {"a": 1, "b": 1}}, "b has 1 elements, not 2"),
        (ca.DM.zeros(4), "the column has 4 elements, not 5"),
    ],
)
def test_parts_that_do_not_fit_are_named(parts: Parts, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        STATES.join(parts)


def test_signals_are_found_by_name() -> None:
    u = slots(SAMPLED, "input").split(ca.DM([3, 4]))
    assert float(u["push.y"]) == 4.0
    assert numbers(u.vector("push", "yx")) == [4, 3]
    assert float(u.over(2 * u.column)["push.x"]) == 6.0
    with pytest.raises(KeyError):
        u["pull"]
    assert named("place", "xy", u.column) == {"place.x": 3, "place.y": 4}


@pytest.mark.parametrize("condition", [0.0, 1.0])
def test_parts_are_chosen_together(condition: float) -> None:
    one, other = {"a": ca.DM(1), "inner": {"b": ca.DM(2)}}, {"a": ca.DM(3), "inner": {"b": ca.DM(4)}, "rest": 5}
    found = choose(ca.DM(condition), one, other)
    assert [float(found["a"]), float(found["inner"]["b"])] == ([1.0, 2.0] if condition else [3.0, 4.0])


@block(p=slots(SAMPLED, "parameter"), x=STATES, T=1)
def later(p: Signals, x: Parts, T: ca.SX) -> tuple[Parts, ca.SX]:
    return x | {"place": x["place"] * ca.exp(-p["rate"] * T)}, ca.sumsqr(x["pair"]["b"])


def test_a_block_is_called_like_its_equations_from_numbers_and_from_both_kinds_of_symbols() -> None:
    x, size = later([2.0, 0.1], [1, 2, 3, 4, 5], 0.5)
    assert np.array(x["place"]).ravel() == pytest.approx(np.exp(-1.0) * np.array([1.0, 2.0]))
    assert float(size) == 41.0
    for symbol in (ca.SX, ca.MX):
        p, state = slots(SAMPLED, "parameter").split(symbol.sym("p", 2)), STATES.split(symbol.sym("x", 5))
        assert isinstance(later(p, state, 0.5)[0]["pair"]["a"], symbol)
    assert later.function is later.function


def test_a_block_stays_one_function_in_a_graph_of_calls() -> None:
    p, x = ca.MX.sym("p", 2), ca.MX.sym("x", 5)
    twice, _ = later(p, STATES.join(later(p, x, 0.5)[0]), 0.5)
    graph = ca.Function("graph", [p, x], [STATES.join(twice)])
    assert [inner.name() for inner in graph.find_functions()] == ["later"]
    assert graph([2.0, 0.1], [1, 2, 3, 4, 5]).full().ravel()[:2] == pytest.approx(np.exp(-2.0) * np.array([1.0, 2.0]))


def _sampled(**changed: object) -> None:
    given = {"initialise": lambda: ({}, {}, {}), "sample": lambda x: (x, named("place", "xy", x["place"]))}
    sampled_kernel(SAMPLED, **{"states": STATES, **given, **changed})


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"sample": lambda x, w: (x, {})}, "Sampled: step takes w, but there is only p, u, x, t"),
        ({"sample": lambda x, d: (x, {})}, "Sampled: step takes d, but there is only"),
        ({"initialise": lambda h: ({}, {}, {})}, "Sampled: initialise takes h, but there is only p, u"),
        ({"sample": lambda x: (x, {})}, r"Sampled: step gives unknown values \[\], missing values \['place.x'"),
        ({"sample": lambda x: ({"place": x["place"]}, {})}, r"Sampled: step gives .* missing values \['pair'\]"),
        ({"initialise": lambda: ({}, {"plaice": 1}, {})}, r"Sampled: initialise gives unknown values \['plaice'\]"),
        ({"initialise": lambda: ({}, {})}, "Sampled: initialise gives 2 results, not 3"),
    ],
)
def test_equations_that_do_not_fit_their_component_are_told(changed: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        _sampled(**changed)


def test_what_initialise_leaves_out_is_zero() -> None:
    kernel = sampled_kernel(
        SAMPLED,
        states=STATES,
        initialise=lambda p: ({}, {"pair": {"a": p["rate"], "b": ca.SX([7, 8])}}, {"place.y": p["rate"]}),
        sample=lambda x: (x, named("place", "xy", x["place"])),
    )
    d, x, y = kernel.initialise([2.0, 0.1], [0, 0], [], [], 0)
    assert d.shape == (0, 1)
    assert numbers(x) == [0, 0, 2, 7, 8]
    assert numbers(y) == [0, 2]


def _place(x: Parts) -> Parts:
    return named("place", "xy", x["place"])


def _decay(p: Signals, u: Signals, x: Parts) -> Parts:
    return {"place": -p["rate"] * x["place"] + u.vector("push", "xy")}


def test_an_integrated_kernel_converges_with_order_four_to_the_exact_one() -> None:
    states, start = Layout(place=2), {"initialise": lambda: ({}, {"place": ca.SX([1, 0])}), "output": _place}

    def step(p: Signals, u: Signals, x: Parts, h: ca.SX) -> Parts:
        rest = u.vector("push", "xy") / p["rate"]
        return {"place": rest + ca.exp(-p["rate"] * h) * (x["place"] - rest)}

    exact = exact_kernel(MOVING, states=states, step=step, **start)
    ours = continuous_kernel(MOVING, states=states, derivative=_decay, **start)
    p, u = np.array([2.0]), np.array([0.3, -0.4])
    _, x, y = ours.initialise(p, u, [], [], 0)
    assert y.full().ravel().tolist() == [1.0, 0.0]
    assert ours.derivative(p, [], u, x).full().ravel() == pytest.approx([-1.7, -0.4])
    errors = [float(ca.norm_2(ours.step(p, [], u, x, h) - exact.step(p, [], u, x, h))) for h in (0.2, 0.1)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.1)  # of one step


def test_states_are_projected_after_every_step() -> None:
    kernel = continuous_kernel(
        MOVING,
        states=Layout(place=2),
        initialise=lambda: ({}, {"place": ca.SX([1, 0])}),
        derivative=_decay,
        output=_place,
        project=lambda x: {"place": x["place"] / ca.norm_2(x["place"])},
    )
    x = kernel.step([2.0], [], [0.3, -0.4], [1.0, 0.0], 0.1)
    assert float(ca.norm_2(x)) == pytest.approx(1.0, abs=1e-15)


def test_the_step_of_order_four_knows_how_much_of_it_has_gone() -> None:
    errors = []
    for n in (10, 20):
        h, x = 1.0 / n, np.array([1.0])
        for k in range(n):
            x = rk4(lambda y, part, t=k * h, h=h: y * np.cos(t + part * h), x, h)
        errors.append(abs(float(x[0]) - np.exp(np.sin(1.0))))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.2)
