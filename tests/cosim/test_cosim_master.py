"""The master against slaves of lambdas: the exact instants and values at which inputs were set."""

from cosim_mocks import Mock, face, mastered, simulate

from cosim.model.face import Port
from cosim.model.system import System


def counter(outputs, step, **options):
    """A sampled mock whose output is the time of its last sample plus one."""
    return Mock(face({}, {outputs: "m"}, step=step, **options), lambda t, h, u: {outputs: t + 1.0})


def test_multirate_instants_and_values():
    """A 20 ms source feeds a 10 ms follower, which feeds a 5 ms integrator."""
    system = System()
    source = counter("a", 0.02)
    follower = Mock(face({"a": "m"}, {"b": "m"}, step=0.01), lambda t, h, u: {"b": 10.0 * u["a"]})
    plant = Mock(face({"b": "m"}, {"y": "m"}, step=0.005, continuous=True), lambda t, h, u: {"y": u["b"] * (t + h)})
    for name in ("plant", "follower", "source"):
        system.add(name, "Mock")
    system.connect("source", "follower")
    system.connect("follower", "plant")
    outcome, rows = simulate(system, {"plant": plant, "follower": follower, "source": source}, 0.04)

    assert source.steps == [(0.0, 0.02, {}), (0.02, 0.02, {})]
    assert follower.steps == [
        (0.0, 0.01, {"a": 1.0}),
        (0.01, 0.01, {"a": 1.0}),
        (0.02, 0.01, {"a": 1.02}),
        (0.03, 0.01, {"a": 1.02}),
    ]
    assert [t for t, _, _ in plant.steps] == [0.0, 0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.035]
    assert [u["b"] for _, _, u in plant.steps] == [10.0] * 4 + [10.2] * 4
    assert [row["time"] for row in rows] == [0.0, 0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.035, 0.04]
    assert outcome.status == "ok"
    assert outcome.calls == {"plant": 8, "follower": 4, "source": 2}


def test_a_row_holds_sampled_values_of_the_tick_and_plant_values_before_the_step():
    system = System()
    controller = Mock(face({"y": "m"}, {"u": "m"}, step=0.01), lambda t, h, u: {"u": u["y"] + 100.0})
    plant = Mock(
        face({"u": "m"}, {"y": "m"}, step=0.01, continuous=True),
        lambda t, h, u: {"y": round(100 * (t + h))},
        {"y": 0.0},
    )
    system.add("controller", "Mock")
    system.add("plant", "Mock")
    system.connect("controller", "plant")
    system.connect("plant", "controller")
    _, rows = simulate(system, {"controller": controller, "plant": plant}, 0.03)
    assert [(row["plant.y"], row["controller.u"]) for row in rows] == [(0, 100), (1, 101), (2, 102), (3, 102)]


def test_continuous_slaves_exchange_in_parallel():
    """Jacobi: each of two coupled plants sees the other's value at the start of the step."""
    system, mocks = System(), {}
    for own, other in (("a", "b"), ("b", "a")):
        system.add(own, "Mock")
        mocks[own] = Mock(
            face({other: "m"}, {own: "m"}, step=0.01, continuous=True),
            lambda t, h, u, own=own, other=other: {own: u[other] + 1.0},
        )
    system.connect("a", "b")
    system.connect("b", "a")
    _, rows = simulate(system, mocks, 0.03)
    assert [(row["a.a"], row["b.b"]) for row in rows] == [(0, 0), (1, 1), (2, 2), (3, 3)]


def test_a_slow_plant_publishes_at_the_end_of_its_step():
    system = System()
    slow = Mock(face({}, {"y": "m"}, step=0.03, continuous=True), lambda t, h, u: {"y": t + h})
    fast = Mock(face({"y": "m"}, {"z": "m"}, step=0.01), lambda t, h, u: {"z": u["y"]})
    system.add("slow", "Mock")
    system.add("fast", "Mock")
    system.connect("slow", "fast")
    simulate(system, {"slow": slow, "fast": fast}, 0.06)
    assert [u["y"] for _, _, u in fast.steps] == [0.0, 0.0, 0.0, 0.03, 0.03, 0.03]


def test_the_last_plant_step_ends_at_the_stop_time():
    system = System()
    plant = Mock(face({}, {"y": "m"}, step=0.01, continuous=True), lambda t, h, u: {"y": t + h})
    system.add("plant", "Mock")
    _, rows = simulate(system, {"plant": plant}, 0.025)
    assert [(t, h) for t, h, _ in plant.steps] == [(0.0, 0.01), (0.01, 0.01), (0.02, 0.005)]
    assert rows[-1] == {"time": 0.025, "plant.y": 0.025}


def test_a_cycle_repeats_beyond_its_first_period():
    system = System()
    mocks = {"a": counter("x", 0.002), "b": counter("y", 0.003)}
    for name in mocks:
        system.add(name, "Mock")
    simulate(system, mocks, 0.06)
    assert [t for t, _, _ in mocks["a"].steps] == [k * 2 / 1000 for k in range(30)]
    assert [t for t, _, _ in mocks["b"].steps] == [k * 3 / 1000 for k in range(20)]


def test_initialisation_sets_parameters_and_passes_outputs_on():
    system = System()
    system.add("source", "Mock", {"gain": "2.5"})
    system.add("sink", "Mock")
    system.connect("source", "sink")
    source = Mock(face({}, {"a": "m"}, extra=(Port("gain", 0, "parameter"),)), lambda t, h, u: {}, {"a": 7.0})
    sink = Mock(face({"a": "m"}, {"b": "m"}), lambda t, h, u: {"b": u["a"]})
    mastered(system, {"source": source, "sink": sink})
    assert source.log == [("set", {"gain": 2.5}), ("enter",), ("leave",)]
    outcome, rows = simulate(system, {"source": source, "sink": sink}, 0.01)
    assert outcome.status == "ok"
    assert sink.steps[0][2] == {"a": 7.0}
    assert rows[0]["sink.b"] == 7.0


def test_units_are_converted_on_the_way():
    system = System()
    source = Mock(face({}, {"t": "degC", "d": "m"}), lambda t, h, u: {"t": 20.0, "d": 1.5})
    sink = Mock(face({"t": "K", "d": "mm"}, {"x": "m"}), lambda t, h, u: {})
    system.add("source", "Mock")
    system.add("sink", "Mock")
    system.connect("source", "sink")
    simulate(system, {"source": source, "sink": sink}, 0.01)
    assert sink.steps[0][2] == {"t": 293.15, "d": 1500.0}


def test_a_discard_ends_the_run_with_one_sentence():
    system = System()
    plant = Mock(face({}, {"y": "m"}, continuous=True), lambda t, h, u: 2 if t >= 0.03 else {"y": t + h})
    plant.reason = "the wheel came off."
    system.add("plant", "Mock")
    outcome, rows = simulate(system, {"plant": plant}, 0.1)
    assert outcome.status == "failed"
    assert outcome.reason == "plant failed at 0.03 s (discard): the wheel came off"
    assert outcome.time == 30_000_000
    assert [row["plant.y"] for row in rows] == [0.0, 0.01, 0.02, 0.03]


def test_a_warning_does_not_stop_the_run():
    system = System()
    plant = Mock(face({}, {"y": "m"}), lambda t, h, u: 1)
    system.add("plant", "Mock")
    assert simulate(system, {"plant": plant}, 0.1)[0].status == "ok"


def test_an_interrupt_keeps_what_was_done():
    system = System()
    plant = Mock(face({}, {"y": "m"}, step=0.001), lambda t, h, u: {"y": t})
    system.add("plant", "Mock")
    master, _ = mastered(system, {"plant": plant})
    outcome = master.run(10**9, lambda: None, interrupted=lambda: len(plant.steps) > 100)
    assert outcome.status == "interrupted"
    assert 100 < len(plant.steps) < 200
    assert outcome.time == (len(plant.steps) - 1) * 1_000_000
