"""A user's FMU in the place of an instance: what fits of it is wired, what does not is told."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cosim.engine.loader import Loader
from cosim.errors import CosimError, unknown
from cosim.model.assembly import assemble
from cosim.model.clock import to_seconds
from cosim.model.configuration import SAMPLE_PERIOD, SETTABLE, Configuration, names
from cosim.model.face import Face, Value
from cosim.model.node import Node
from cosim.model.patterns import matches
from cosim.model.system import System

_SHOWN = 6
"""So many names stand in a sentence at most."""


@dataclass(frozen=True, slots=True)
class Replaced:
    """An instance whose `original` node has given way to the FMU `file`.

    `values` are what the original started with, `feeds` the inputs it fed, by instance.
    """

    file: str
    original: Node
    values: Mapping[str, Value]
    feeds: Mapping[str, Sequence[str]]

    def gone(self, face: Face) -> dict[str, Value]:
        """Values of what the original had and its replacement has not."""
        return {name: value for name, value in self.values.items() if name not in names(face, *SETTABLE)}

    def silent(self, face: Face) -> Iterator[str]:
        """Signals that the original gave and its replacement does not."""
        lost = (*self.original.face.numbers, *self.original.face.texts)
        return (f"{self.original.name}.{name}" for name in lost if name not in names(face, "output"))


def replaced(system: System, asked: Sequence[tuple[str, Path]], loader: Loader) -> dict[str, Replaced]:
    """Put the FMUs `asked` for, by a name or a pattern of instances, in their places; the originals by name.

    An FMU runs as its original did, as a plant or a controller, and as often unless it says how often.
    Raises CosimError for an instance there is none of.
    """
    if not asked:
        return {}
    files = dict(_placed(system, asked))
    configuration = Configuration(system, loader.faces(system))
    nodes = assemble(configuration, 0)
    originals = {
        name: Replaced(file.name, nodes[name], configuration.values(name), _feeds(name, nodes))
        for name, file in files.items()
    }
    for name, file in files.items():
        system.instances[name].model = str(file)
    faces = loader.faces(system)
    for name in files:
        _fit(system, nodes[name], faces[name])
    system.wires = [replace(wire, lenient=bool({wire.source, wire.target} & files.keys())) for wire in system.wires]
    system.links = [
        link
        for link in system.links
        if link.output in names(faces[link.source], "output") and link.input in names(faces[link.target], "input")
    ]
    return originals


def misfits(originals: Mapping[str, Replaced], nodes: Mapping[str, Node]) -> list[str]:
    """One sentence on each kind of thing that does not fit: inputs, outputs that others read, values."""
    found = []
    for name, original in originals.items():
        face, what = nodes[name].face, f"{original.file} in the place of {name}"
        lost = [c for node in nodes.values() for c in _lost(original, node)]
        unread = [input_ for input_ in original.original.incoming if input_ not in nodes[name].incoming]
        fed = nodes[name].incoming
        free = [input_ for input_ in face.inputs if input_ not in fed]
        changed = [key for key in original.gone(face) if key in original.original.values and key != SAMPLE_PERIOD]
        found += [
            f"{what} does not read {_some(unread)}" if unread else "",
            f"{what} has no output for {_some(lost)}: such inputs keep their start values" if lost else "",
            f"{what} has inputs that nothing feeds: {_some(free)}" if free else "",
            f"{what} has no place for the values of {_some(changed)}" if changed else "",
        ]
    return [sentence for sentence in found if sentence]


def _lost(original: Replaced, node: Node) -> list[str]:
    """Inputs of the node that the original fed and that nothing feeds now."""
    fed = original.feeds.get(node.name, ())
    return [f"{node.name}.{input_}" for input_ in fed if input_ not in node.incoming]


def _feeds(name: str, nodes: Mapping[str, Node]) -> dict[str, list[str]]:
    return {
        target: [input_ for input_, connection in node.incoming.items() if connection.source == name]
        for target, node in nodes.items()
    }


def _placed(system: System, asked: Iterable[tuple[str, Path]]) -> Iterator[tuple[str, Path]]:
    for pattern, file in asked:
        fitting = [name for name in system.instances if matches(name, pattern)]
        if not fitting:
            raise unknown("instance", pattern, system.instances, "`--explain` lists the instances")
        if file.suffix != ".fmu" or not file.is_file():
            raise CosimError(f"{file} cannot take the place of {pattern}: give the path of an .fmu file")
        yield from ((name, file) for name in fitting)


def _fit(system: System, original: Node, face: Face) -> None:
    """The instance runs as its original did; values of its system that it has no place for are dropped."""
    name, instance = original.name, system.instances[original.name]
    instance.kind = instance.kind or original.kind
    if instance.period is None and face.step is None:
        instance.period = to_seconds(original.period)
    known = set(names(face, *SETTABLE))
    instance.parameters = {key: value for key, value in instance.parameters.items() if key in known}
    missing = {f"{name}.{key}" for key in original.face.ports if key not in known}
    system.assignments = [each for each in system.assignments if each.signal not in missing]
    system.events = [each for each in system.events if each.signal not in missing]


def _some(names_: Sequence[str]) -> str:
    """The names, of many only the first."""
    more = len(names_) - _SHOWN
    return ", ".join(names_[:_SHOWN]) + (f" and {more} more" if more > 0 else "")
