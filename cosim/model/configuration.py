"""The values a system starts with: what was set of its instances, else the start values of their models.

Everything is resolved here, once: patterns are expanded, texts take the type of their variable, and every value is
held against its range. What a scenario derives from these values it adds as defaults, which what was set overrules.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cosim.errors import CosimError, unknown
from cosim.model.face import Face, Port, Value
from cosim.model.patterns import fits_beginning, is_pattern, matches
from cosim.model.system import System
from cosim.model.values import coerce

SAMPLE_PERIOD = "sample_period"
LOOK = "`fmus list --json` lists the variables of every model, `fmpy info FILE.fmu` those of a file"
SETTABLE = ("parameter", "input")
"""Causalities of the variables that can be set."""


class Configuration:
    """Values of all parameters and inputs of `system` before the start; `faces` are those of its models.

    Both are by the name of the instance. Raises CosimError, in the words the user typed, for a variable that does not
    exist or cannot be set, and for a value that is not of its type or outside its range.
    `gone` are values of variables that an instance had before another model took its place: they can still be asked
    for, and defaults of them are no more than that.
    """

    def __init__(
        self, system: System, faces: Mapping[str, Face], gone: Mapping[str, Mapping[str, Value]] | None = None
    ) -> None:
        self.system, self.faces = system, faces
        self._gone: dict[str, dict[str, Value]] = {name: dict(values) for name, values in (gone or {}).items()}
        self._set: dict[str, dict[str, Value]] = {name: {} for name in system.instances}
        for name, instance in system.instances.items():
            for variable, value in instance.parameters.items():
                self._store(name, variable, value, f"{name}.{variable}")
        for assignment in system.assignments:
            for name, variable in selected(system, faces, assignment.signal, SETTABLE):
                self._store(name, variable, assignment.value, assignment.signal)
        for name, instance in system.instances.items():
            if instance.period is not None and SAMPLE_PERIOD in faces[name].ports:
                self.default(name, SAMPLE_PERIOD, instance.period)

    def __contains__(self, instance: str) -> bool:
        return instance in self._set

    def model(self, instance: str) -> str:
        """The name of the instance's model."""
        return self.system.instances[instance].model

    def value(self, instance: str, variable: str) -> Value:
        """What the variable starts with: the value set or defaulted, else the start value of the model."""
        if variable in self._set[instance]:
            return self._set[instance][variable]
        return self.start(instance, variable)

    def start(self, instance: str, variable: str) -> Value:
        """The start value of the model, whatever was set."""
        if variable in self._gone.get(instance, ()):
            return self._gone[instance][variable]
        start = self._port(instance, variable, f"{instance}.{variable}").start
        if start is None:
            raise CosimError(f"{instance}.{variable} has no start value; set it")
        return start

    def number(self, instance: str, variable: str) -> float:
        """As `value`, of a variable that is a number; raises CosimError for a text."""
        value = self.value(instance, variable)
        if isinstance(value, str):
            raise CosimError(f"{instance}.{variable} is a text, not a number")
        return float(value)

    def values(self, instance: str) -> dict[str, Value]:
        """What all parameters and inputs of the instance start with, by name; those without a start value left out."""
        ports = self.faces[instance].ports.values()
        starts = {p.name: p.start for p in ports if p.causality in SETTABLE and p.start is not None}
        return self._gone.get(instance, {}) | starts | self._set[instance]

    def changed(self, instance: str) -> dict[str, Value]:
        """The values that were set or defaulted, by name."""
        return dict(self._set[instance])

    def default(self, instance: str, variable: str, value: Value, of: Sequence[str] = ()) -> None:
        """The variable starts with `value` unless it was set.

        `of` are the signals, as `instance.variable`, from which the value was derived: where it is outside the range
        of the variable the error names them, as they are what can be changed.
        """
        if variable in self._gone.get(instance, ()):
            self._gone[instance][variable] = value
            return
        if variable in self._set[instance]:
            return
        try:
            self._store(instance, variable, value, f"{instance}.{variable}")
        except CosimError as error:
            if not of:
                raise
            given = " and ".join(f"{name} = {_shown(self.value(*self.system.split(name)))}" for name in of)
            raise CosimError(
                f"{given} does not fit, because {error} and follows from it; "
                f"give it another value, or set {instance}.{variable} as well"
            ) from None

    def follow(self, instance: str, variable: str, of: str) -> None:
        """The variable starts with the value of the signal `of`, an `instance.variable`, unless it was set.

        Where that is its start value anyway nothing is set.
        """
        value = self.value(*self.system.split(of))
        if value != self.start(instance, variable):
            self.default(instance, variable, value, [of])

    def _store(self, instance: str, variable: str, value: Value, typed: str) -> None:
        port = self._port(instance, variable, typed)
        if port.causality not in SETTABLE:
            raise CosimError(f"{typed} is an {port.causality} of {self.faces[instance].model} and cannot be set")
        self._set[instance][variable] = coerce(typed, port, value)

    def _port(self, instance: str, variable: str, typed: str) -> Port:
        face = self.faces[instance]
        if variable not in face.ports:
            raise unknown(f"variable of {instance} ({face.model})", variable, names(face, *SETTABLE), LOOK)
        return face.ports[variable]


def _shown(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def names(face: Face, *causalities: str) -> list[str]:
    """The names of a model's variables of these causalities."""
    return [port.name for port in face.ports.values() if port.causality in causalities]


def selected(
    system: System, faces: Mapping[str, Face], signal: str, causalities: Sequence[str]
) -> Iterator[tuple[str, str]]:
    """(instance, variable) of all that `signal` means: one name, or all that a pattern fits among the `causalities`.

    A name is what names an existing variable, or holds no character of patterns. Raises CosimError for an instance
    there is none of, and for a pattern that nothing fits.
    """
    if system.is_name(signal):
        instance, variable = system.split(signal)
        if not is_pattern(variable) or variable in faces[instance].ports:
            yield instance, variable
            return
    fitting = [
        (name, variable)
        for name in system.instances
        if fits_beginning(name, signal)
        for variable in names(faces[name], *causalities)
        if matches(f"{name}.{variable}", signal)
    ]
    if not fitting:
        raise _nothing_fits(system, faces, signal, causalities)
    yield from fitting


def _nothing_fits(system: System, faces: Mapping[str, Face], pattern: str, causalities: Sequence[str]) -> CosimError:
    near = [name for name in system.instances if fits_beginning(name, pattern)]
    if not near:
        return CosimError(
            f"no instance fits the pattern {pattern!r}; * and ? stand for characters between two dots and ** for any, "
            "as in car*.llc.filter.speed, and `--explain` lists the instances"
        )
    depth = max(name.count(".") for name in near) + 1
    variable = ".".join(pattern.split(".")[depth:])
    kind = "input" if causalities == ("input",) else "variable"
    known = {each for name in near for each in names(faces[name], *causalities)}
    return unknown(f"{kind} of the instances that fit {pattern!r}", variable, known, LOOK)
