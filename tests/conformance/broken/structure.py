"""Broken structures: X37 to X45."""

from __future__ import annotations

from typing import Any

from lxml import etree

from broken.making import add_variable, description, unknowns, variable


@description("X37", "Outputs lists the index")
def _listed_twice(root: Any) -> None:
    etree.SubElement(unknowns(root, "Outputs"), "Unknown", dict(unknowns(root, "Outputs")[0].attrib))


@description("X37", "InitialUnknowns lists the index 99999, but there are")
def _no_variable(root: Any) -> None:
    etree.SubElement(unknowns(root, "InitialUnknowns"), "Unknown", index="99999")


@description("X38", "Outputs lacks")
def _lacking(root: Any) -> None:
    del unknowns(root, "Outputs")[0]


@description("X38", "but it is no output")
def _no_output(root: Any) -> None:
    etree.SubElement(unknowns(root, "Outputs"), "Unknown", index="1")


@description("X39", "which has no attribute derivative")
def _no_derivative(root: Any) -> None:
    derivatives = etree.Element("Derivatives")
    etree.SubElement(derivatives, "Unknown", index=unknowns(root, "Outputs")[0].get("index"))
    unknowns(root, "Outputs").addnext(derivatives)


def _derive(root: Any, *states: Any) -> None:
    """Expose derivatives of these variables."""
    variables, derivatives = root.find("ModelVariables"), etree.Element("Derivatives")
    for number, state in enumerate(states):
        index = 1 + list(variables).index(state)
        add_variable(root, f"rate{number}", {"causality": "local"}, derivative=str(index))
        etree.SubElement(derivatives, "Unknown", index=str(len(variables)))
        etree.SubElement(unknowns(root, "InitialUnknowns"), "Unknown", index=str(len(variables)))
    unknowns(root, "Outputs").addnext(derivatives)


@description("X49", "which is no state: its causality is input")
def _derivative_of_an_input(root: Any) -> None:
    variable(root, "input").set("variability", "continuous")
    _derive(root, variable(root, "input"))


@description("X49", "more than one derivative refers to state")
def _two_derivatives(root: Any) -> None:
    add_variable(root, "state", {"causality": "local", "initial": "exact"}, start="0")
    state = root.find("ModelVariables")[-1]
    _derive(root, state, state)


@description("X40", "it is unknown at the start")
def _not_unknown(root: Any) -> None:
    del unknowns(root, "InitialUnknowns")[0]


@description("X41", "follows")
def _order_of_unknowns(root: Any) -> None:
    listed = unknowns(root, "InitialUnknowns")
    listed.append(listed[0])


@description("X42", "depends on the index 99999")
def _no_dependency(root: Any) -> None:
    unknowns(root, "Outputs")[0].set("dependencies", "99999")


@description("X42", "not each once in order")
def _dependency_order(root: Any) -> None:
    indices = [str(i) for i, v in enumerate(root.iter("ScalarVariable"), start=1) if v.get("causality") == "input"]
    unknowns(root, "Outputs")[0].set("dependencies", " ".join(reversed(indices)))


@description("X43", "a fixed parameter")
def _known_parameter(root: Any) -> None:
    unknowns(root, "Outputs")[0].set("dependencies", "1")


@description("X44", "whose initial is calculated")
def _circular(root: Any) -> None:
    unknowns(root, "InitialUnknowns")[0].set("dependencies", unknowns(root, "InitialUnknowns")[1].get("index"))


@description("X45", "0 dependencies and 1 kinds")
def _kinds(root: Any) -> None:
    unknowns(root, "Outputs")[0].set("dependenciesKind", "dependent")
