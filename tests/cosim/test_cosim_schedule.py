from random import Random

from cosim_mocks import assembled, face

from cosim.engine.schedule import active_ticks, schedule
from cosim.model.system import System


def chain(edges, periods, continuous=()):
    """A schedule of instances wired by `edges`, listed in the order of `periods`."""
    system, faces = System(), {}
    for name, period in periods.items():
        ins = {f"from_{a}": "m" for a, b in edges if b == name}
        faces[name] = face(ins, {"out": "m"}, step=period, continuous=name in continuous)
        system.add(name, "Mock")
    for a, b in edges:
        system.connect(a, b, {f"from_{a}": "out"})
    return schedule(assembled(system, faces))


def test_dataflow_order_whatever_the_listing():
    plan = chain(
        [("plant", "imu"), ("imu", "filter"), ("filter", "hlc"), ("hlc", "llc"), ("filter", "llc"), ("llc", "plant")],
        {"llc": 0.001, "hlc": 0.02, "filter": 0.005, "plant": 0.001, "imu": 0.005},
        continuous={"plant"},
    )
    assert plan.sequential == ("imu", "filter", "hlc", "llc")
    assert plan.parallel == ("plant",)
    assert plan.broken == ()
    assert (plan.tick, plan.cycle) == (1_000_000, 20_000_000)


def test_unrelated_instances_keep_their_order():
    assert chain([], {"b": 0.01, "a": 0.01, "c": 0.01}).sequential == ("b", "a", "c")


def test_a_cycle_is_broken_at_its_slowest_edge():
    plan = chain([("a", "b"), ("b", "c"), ("c", "a")], {"a": 0.01, "b": 0.1, "c": 0.02})
    assert plan.broken == (("b", "c"),)
    assert plan.sequential == ("c", "a", "b")


def test_two_cycles_through_one_instance_are_both_broken():
    plan = chain([("a", "b"), ("b", "a"), ("b", "c"), ("c", "b")], {"a": 0.05, "b": 0.01, "c": 0.02})
    assert set(plan.broken) == {("a", "b"), ("c", "b")}
    assert plan.sequential == ("b", "a", "c")


def test_active_ticks_skip_instants_at_which_nothing_is_due():
    ticks = list(active_ticks({"a": 3, "b": 7}, 10))
    assert ticks == [(0, ("a", "b")), (3, ("a",)), (6, ("a",)), (7, ("b",)), (9, ("a",))]


def test_any_dataflow_runs_sources_first_and_as_listed_where_there_is_a_choice():
    """Random graphs, against the definition: always the first listed whose sources have all run."""
    random = Random(7)
    for size in (2, 5, 9, 14):
        names = [f"i{k}" for k in range(size)]
        rank = random.sample(range(size), size)
        pairs = [(a, b) for a in range(size) for b in range(size) if rank[a] < rank[b] and random.random() < 0.3]
        edges = [(names[a], names[b]) for a, b in pairs]
        expected: list[str] = []
        while len(expected) < size:
            free = [n for n in names if n not in expected and all(a in expected for a, b in edges if b == n)]
            expected.append(free[0])
        assert chain(edges, dict.fromkeys(names, 0.01)).sequential == tuple(expected)
