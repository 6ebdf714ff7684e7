"""Broken variables: X22 to X29."""

from __future__ import annotations

from typing import Any

from lxml import etree

from broken.making import add_variable, description, variable

DISCRETE = {"causality": "local", "variability": "discrete"}


@description("X22", "2 variables have the name 'fault'")
def _two_names(root: Any) -> None:
    add_variable(root, "fault", DISCRETE)


@description("X23", "'3rd wheel' is no structured name")
def _name(root: Any) -> None:
    variable(root, "parameter").set("name", "3rd wheel")


@description("X24", "the Boolean variable fault is continuous by default")
def _by_default(root: Any) -> None:
    del variable(root, "output", "Boolean").attrib["variability"]


@description("X25", "causality parameter with variability continuous")
def _moving_parameter(root: Any) -> None:
    variable(root, "parameter").set("variability", "continuous")


@description("X26", "has initial exact, which a discrete input must not have")
def _initial(root: Any) -> None:
    variable(root, "input").set("initial", "exact")


@description("X27", "time, clock are all independent")
def _two_times(root: Any) -> None:
    for name in ("time", "clock"):
        add_variable(root, name, {"causality": "independent"})


@description("X28", "can all be set")
def _alias(root: Any) -> None:
    variable(root, "input", nth=1).set("valueReference", variable(root, "input").get("valueReference"))


@description("X28", "have the units m, rad/s")
def _alias_units(root: Any) -> None:
    add_variable(root, "alias", DISCRETE, unit="m")
    output = next(
        v for v in root.iter("ScalarVariable") if v.get("causality") == "output" and v[0].get("unit") == "rad/s"
    )
    root.find("ModelVariables")[-1].set("valueReference", output.get("valueReference"))


@description("X46", "has it, but the FMU is not for model exchange")
def _multiple_set(root: Any) -> None:
    variable(root, "input").set("canHandleMultipleSetPerTimeInstant", "false")


@description("X46", "has it, but its causality is parameter")
def _multiple_set_of_a_parameter(root: Any) -> None:
    exchange = etree.Element("ModelExchange", modelIdentifier=root.find("CoSimulation").get("modelIdentifier"))
    root.find("CoSimulation").addprevious(exchange)
    variable(root, "parameter").set("canHandleMultipleSetPerTimeInstant", "true")


@description("X29", "which is no other variable")
def _derivative(root: Any) -> None:
    add_variable(root, "rate", {"causality": "local"}, derivative="99999")
