"""From a system structure description (SSD, chapter 5) and what it refers to, to a tree of systems and components."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from lxml import etree

from cosim.errors import CosimError
from cosim.ssp.content import Content, suppressed
from cosim.ssp.document import Element, Where, checked, parsed
from cosim.ssp.namespaces import DESCRIPTION, SIGNAL_DICTIONARY, SSB, SSD
from cosim.ssp.parameters import bindings
from cosim.ssp.places import DEFAULT, Archives, Folder, located, read_file, read_inside
from cosim.ssp.structure import Component, Connector, End, Joint, Reference, Tree

FMU = "application/x-fmu-sharedlibrary"
_NESTED = ("application/x-ssp-definition", "application/x-ssp-package")
_DICTIONARY = "application/x-ssp-signal-dictionary"
_DEEPEST = 20
_MOST = 20_000


@dataclass(frozen=True, slots=True)
class Description:
    """One SSD: its root element, the folder it lies in, what it is called, and the files it is nested in."""

    root: Element
    folder: Folder
    file: str
    within: tuple[tuple[Path, str], ...] = ()
    content: Content = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "content", Content(self.root, SSD, self.file))


def described(path: Path, folder: Folder, within: tuple[tuple[Path, str], ...] = ()) -> Description:
    """The SSD at `path` in `folder`."""
    called = folder.called(path)
    return Description(parsed(read_file(path, called), called, DESCRIPTION), folder, called, within)


class Reader:
    """Reads the systems of descriptions; `archives` keeps what nested packages contain.

    `models` are the FMUs that were found, by what they are called.
    """

    def __init__(self, archives: Archives) -> None:
        self._archives, self._count = archives, 0
        self.models: dict[str, Path] = {}

    def root(self, description: Description) -> Tree:
        """The root system of a description."""
        return self._system(_only(description.root, "System"), description)

    def package(self, archive: Path, called: str, variant: str, within: tuple[tuple[Path, str], ...]) -> Description:
        """The SSD `variant` of a package, its SystemStructure.ssd if that is empty."""
        folder = self._archives.opened(archive, called)
        path = folder.path / (variant or DEFAULT)
        if not (path.parent == folder.path and path.is_file()):
            raise CosimError(f"{called} has no {variant or DEFAULT}, so it is no system structure package")
        return described(path, folder, within)

    def _system(self, element: Element, of: Description) -> Tree:
        name, where = element.get("name", ""), of.content.where(element)
        elements: dict[str, Component | Tree | Reference] = {}
        for child in _children(element, "Elements"):
            _add(elements, child.get("name", ""), self._element(child, of), of.content.where(child), name)
        return Tree(
            name,
            _connectors(element, of, name),
            elements,
            tuple(_joint(child, of) for child in _children(element, "Connections")),
            bindings(element, of.file, partial(_fetched, of, None)),
            _dictionaries(element, of),
            where,
        )

    def _element(self, element: Element, of: Description) -> Component | Tree | Reference:
        kind, name = etree.QName(element).localname, element.get("name", "")
        self._count += 1
        if self._count > _MOST:
            raise CosimError(f"{of.content.where(element)}: the system has more than {_MOST} elements")
        if kind == "System":
            return self._system(element, of)
        if kind == "SignalDictionaryReference":
            return Reference(
                name, element.get("dictionary", ""), _connectors(element, of, name), of.content.where(element)
            )
        return self._component(element, name, of)

    def _component(self, element: Element, name: str, of: Description) -> Component | Tree:
        where, type_, source = of.content.where(element), element.get("type", FMU), element.get("source", "")
        if type_ not in (FMU, *_NESTED):
            raise CosimError(f"{where}: component {name!r} is of type {type_}; FMUs, SSDs and SSPs can be read")
        if not source:
            raise CosimError(f"{where}: component {name!r} has no source; give it the URI of its FMU")
        if source.startswith("#"):
            return self._again(element, name, source[1:], of)
        path, fragment = located(source, of.folder, where)
        if type_ == FMU and path.suffix.lower() not in (".ssp", ".ssd"):
            self.models[of.folder.model(path)] = path
            return _fmu(element, name, path, of)
        inner = self._nested(path, fragment, name, of, where)
        return self._placed(element, name, self.root(inner), inner.folder, of)

    def _nested(self, path: Path, fragment: str, name: str, of: Description, where: Where) -> Description:
        """The description that a component refers to, which must not contain the component."""
        key = (path, fragment)
        if key in of.within or len(of.within) >= _DEEPEST:
            seen = "contains itself" if key in of.within else f"is nested more than {_DEEPEST} deep"
            raise CosimError(f"{where}: component {name!r} is {of.folder.called(path)}, which {seen}; take it out")
        within = (*of.within, key)
        if path.suffix.lower() == ".ssp":
            return self.package(path, of.folder.called(path), fragment, within)
        return described(path, of.folder.holding(path), within)

    def _again(self, element: Element, name: str, identifier: str, of: Description) -> Tree:
        """Another instance of a system of the same description (5.4, `source`)."""
        where = of.content.where(element)
        found = [system for system in of.root.iter(f"{{{SSD}}}System") if system.get("id") == identifier]
        if not found:
            raise CosimError(f"{where}: component {name!r} refers to the system '#{identifier}', which is not there")
        if found[0] in element.iterancestors():
            raise CosimError(f"{where}: component {name!r} is '#{identifier}', which contains itself; take it out")
        key = (Path(of.file), identifier)
        if key in of.within or len(of.within) >= _DEEPEST:
            raise CosimError(f"{where}: component {name!r} is '#{identifier}', which contains itself; take it out")
        deeper = replace(of, within=(*of.within, key))
        return self._placed(element, name, self._system(found[0], deeper), of.folder, of)

    def _placed(self, element: Element, name: str, tree: Tree, inside: Folder, of: Description) -> Tree:
        """The system in place of the component; the component's bindings come after its own (5.2.3)."""
        for connector in _connectors(element, of, name):
            if connector not in tree.connectors:
                where = of.content.where(element)
                raise CosimError(f"{where}: component {name!r} has the connector {connector!r}, its system has not")
        more = bindings(element, of.file, partial(_fetched, of, inside))
        return replace(tree, name=name, bindings=(*tree.bindings, *more))


def _fmu(element: Element, name: str, path: Path, of: Description) -> Component:
    where = of.content.where(element)
    if element.get("implementation") == "ModelExchange":
        raise CosimError(
            f"{where}: component {name!r} asks for model exchange; only co-simulation can run, so let it ask for any"
        )
    found = bindings(element, of.file, partial(_fetched, of, path))
    return Component(name, of.folder.model(path), path, _connectors(element, of, name), found, where)


def _fetched(of: Description, component: Path | Folder | None, uri: str, base: str, where: Where) -> tuple[bytes, str]:
    """The bytes of a source; those of base "component" lie in the FMU, or beside the nested description."""
    if base != "component":
        path, _ = located(uri, of.folder, where)
        called = of.folder.called(path)
    elif isinstance(component, Folder):
        path, _ = located(uri, component, where)
        called = component.called(path)
    elif component is not None:
        return read_inside(component, uri, where), f"{of.folder.called(component)}: {uri}"
    else:
        raise CosimError(f"{where}: the sourceBase of a system cannot be component; write SSD")
    return read_file(path, called), called


def _add(elements: dict[str, Any], name: str, made: object, where: Where, owner: str) -> None:
    if name in elements:
        raise CosimError(f"{where}: {owner!r} has two elements named {name!r}; name one of them otherwise")
    elements[name] = made


def _connectors(element: Element, of: Description, owner: str) -> dict[str, Connector]:
    found: dict[str, Connector] = {}
    for child in _children(element, "Connectors"):
        connector = of.content.connector(child, owner)
        if connector.name in found:
            raise CosimError(f"{connector.where}: {owner!r} has two connectors named {connector.name!r}; keep one")
        found[connector.name] = connector
    return found


def _joint(element: Element, of: Description) -> Joint:
    start, end = (
        End(element.get(f"{side}Element") or None, element.get(f"{side}Connector", "")) for side in ("start", "end")
    )
    return Joint(start, end, suppressed(element), of.content.change(element), of.content.where(element))


def _dictionaries(element: Element, of: Description) -> dict[str, dict[str, Connector]]:
    """The signal dictionaries of a system by name (5.3.3), each with its entries (chapter 8)."""
    found: dict[str, dict[str, Connector]] = {}
    for child in _children(element, "SignalDictionaries"):
        name, where = child.get("name", ""), of.content.where(child)
        if child.get("type", _DICTIONARY) != _DICTIONARY:
            raise CosimError(
                f"{where}: the signal dictionary {name!r} is of type {child.get('type')}, which is unknown"
            )
        source = child.get("source")
        if source is not None:
            data, file = _fetched(of, None, source, "SSD", where)
            root = parsed(data, file, SIGNAL_DICTIONARY)
        else:
            file, root = (
                of.file,
                checked(next(iter(child.iterchildren(etree.Element)), child), of.file, SIGNAL_DICTIONARY),
            )
        content = Content(root, SSB, file)
        entries = root.iterfind(f"{{{SSB}}}DictionaryEntry")
        _add(found, name, {entry.get("name", ""): content.connector(entry, name) for entry in entries}, where, "")
    return found


def _children(element: Element, group: str) -> Iterable[Element]:
    found = element.find(f"{{{SSD}}}{group}")
    return [] if found is None else found.iterchildren(etree.Element)


def _only(root: Element, name: str) -> Element:
    found = root.find(f"{{{SSD}}}{name}")
    assert found is not None, "the schema wants one"
    return found
