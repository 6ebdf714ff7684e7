"""Samples lie on the component's own grid, whatever steps the host makes."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

import pytest
from fmu_driver import Instance

PERIOD = 5e-3
END = 0.25


def _even(size: float) -> Iterator[float]:
    for _ in range(round(END / size)):
        yield size


def _jitter() -> Iterator[float]:
    """Steps of about 1 ms that end exactly where they should only on the average."""
    generator = random.Random(7)
    before = 0.0
    for k in range(1, 251):
        now = k * 1e-3 + generator.uniform(-1e-10, 1e-10)
        yield now - before
        before = now


def _tiny_steps_between() -> Iterator[float]:
    for _ in range(50):
        yield from (1e-13, PERIOD, 1e-13)


def _uneven() -> Iterator[float]:
    for _ in range(50):
        yield from (0.7e-3, 2.3e-3, 2e-3)


def _samples(instance: Instance, steps: Iterator[float]) -> dict[float, dict[str, float]]:
    """The outputs after each sample, by the number of the sample."""
    seen = {}
    for size in steps:
        instance.set({"measured": 1.0})
        assert instance.step(size), instance.messages
        if instance["count"]:
            seen[instance["count"]] = instance.outputs()
    return seen


@pytest.mark.parametrize(
    "steps",
    [lambda: _even(1e-3), _jitter, _tiny_steps_between, _uneven, lambda: _even(0.125e-3)],
    ids=["1ms", "jitter", "1e-13", "uneven", "0.125ms"],
)
def test_steps_of_the_host_do_not_change_the_samples(
    make: Callable[[str], Instance], steps: Callable[[], Iterator[float]]
) -> None:
    reference = _samples(make("DemoFilter").initialise(), _even(PERIOD))
    assert _samples(make("DemoFilter").initialise(), steps()) == reference
    assert list(reference) == [float(k) for k in range(1, 51)]


def test_grid_starts_at_the_start_time(make: Callable[[str], Instance]) -> None:
    reference = _samples(make("DemoFilter").initialise(), _even(PERIOD))
    assert _samples(make("DemoFilter").initialise(start=3.7), _even(1e-3)) == reference


def test_one_long_step_holds_all_its_samples(make: Callable[[str], Instance]) -> None:
    reference = _samples(make("DemoFilter").initialise(), _even(PERIOD))
    assert _samples(make("DemoFilter").initialise(), _even(2 * PERIOD)) == {
        count: values for count, values in reference.items() if count % 2 == 0
    }


def test_host_that_carries_on_after_a_discard_stays_on_the_grid(make: Callable[[str], Instance]) -> None:
    instance = make("DemoFilter").initialise()
    assert instance.step(PERIOD)
    instance.set({"measured": float("nan")})
    assert not instance.step(PERIOD)
    instance.time += PERIOD
    assert instance.step(PERIOD)
    reference = make("DemoFilter").initialise()
    for _ in range(3):
        reference.step(PERIOD)
    assert instance["noise"] == reference["noise"]
    assert instance["count"] == 2.0


def test_continuous_component_takes_a_tiny_last_step(make: Callable[[str], Instance]) -> None:
    instance = make("DemoSpring").initialise()
    assert instance.step(0.01)
    before = instance["position"]
    assert instance.step(1e-13)
    assert instance["position"] == pytest.approx(before, abs=1e-12)
