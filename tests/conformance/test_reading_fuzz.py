"""No description, however odd, makes a rule itself break down."""

from __future__ import annotations

import contextlib
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import everything
import pytest
from lxml import etree

from fmukit.conformance.package import Package, parse
from fmukit.conformance.rule import NotApplicable
from fmukit.conformance.rulebook import READING

_NUMBERS = ("-1", "0", "1", "3", "99999999999999999999", "NaN", "INF", "-INF", "1e999")
_ODD = (*_NUMBERS, "", "true", "x", "'", "$", "km", "m/s2", "m9999999999", "sqrt(m)", "(", "kg.", "ő\n")


def _change(root: Any, rng: random.Random) -> None:
    element = rng.choice(list(root.iter()))
    name = rng.choice([*element.attrib, "unit", "start", "derivative", "dependencies", "declaredType"])
    choice = rng.random()
    if choice < 0.6:
        element.set(name, rng.choice(_ODD))
    elif choice < 0.75:
        element.attrib.pop(name, None)
    elif element.getparent() is not None and choice < 0.9:
        element.getparent().remove(element)
    else:
        element.append(etree.fromstring(etree.tostring(element)))


@pytest.fixture(scope="module", params=["ours", "everything"])
def sound(request: pytest.FixtureRequest, good: Path, tmp_path_factory: pytest.TempPathFactory) -> Package:
    other = request.param == "everything"
    return Package.read(everything.make(good, tmp_path_factory.mktemp("odd") / "odd.fmu") if other else good)


def test_no_rule_breaks_down(sound: Package) -> None:
    rng = random.Random(20)
    readable = 0
    for _ in range(400):
        root = parse(sound.xml)
        for _ in range(rng.choice((1, 1, 1, 3))):
            _change(root, rng)
        data = etree.tostring(root)
        package = replace(sound, xml=data, root=parse(data))
        readable += package.readable
        for rule in READING[1:]:  # the first reads the whole archive, which stays the same
            with contextlib.suppress(NotApplicable):
                list(rule.violations(package))
    assert readable > 100
