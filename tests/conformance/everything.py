"""A description that uses what our FMUs do not: types, display units, enumerations, aliases, states, time."""

from __future__ import annotations

import zipfile
from pathlib import Path

from broken import XML
from lxml import etree

_DEFINITIONS = """<TypeDefinitions>
  <SimpleType name="Speed"><Real unit="m/s" displayUnit="km/h" min="-100" max="100" nominal="10"/></SimpleType>
  <SimpleType name="Mode">
    <Enumeration><Item name="off" value="0"/><Item name="on" value="3"/></Enumeration></SimpleType>
  <SimpleType name="Flag"><Boolean/></SimpleType>
</TypeDefinitions>"""
_UNITS = """<UnitDefinitions>
  <Unit name="m/s"><BaseUnit m="1" s="-1"/><DisplayUnit name="km/h" factor="3.6"/></Unit>
  <Unit name="m/s2"><BaseUnit m="1" s="-2"/></Unit>
  <Unit name="K"><BaseUnit K="1"/><DisplayUnit name="degC" offset="-273.15"/></Unit>
  <Unit name="our own"/>
</UnitDefinitions>"""
_VARIABLES = """<ModelVariables>
  <ScalarVariable name="time" valueReference="0" causality="independent"><Real/></ScalarVariable>
  <ScalarVariable name="car.wheel[1,2].'any (name)'" valueReference="1" causality="input"><Real start="-1e-3"/>
  </ScalarVariable>
  <ScalarVariable name="v" valueReference="2" causality="output" initial="exact">
    <Real declaredType="Speed" start="5"/></ScalarVariable>
  <ScalarVariable name="v alias" valueReference="2"><Real declaredType="Speed"/></ScalarVariable>
  <ScalarVariable name="der(v)" valueReference="3"><Real unit="m/s2" derivative="3"/></ScalarVariable>
  <ScalarVariable name="der(v,2)" valueReference="4"><Real unit="our own"/></ScalarVariable>
  <ScalarVariable name="gain" valueReference="5" causality="parameter" variability="tunable"><Real start="1"/>
  </ScalarVariable>
  <ScalarVariable name="twice" valueReference="6" causality="calculatedParameter" variability="tunable"><Real/>
  </ScalarVariable>
  <ScalarVariable name="guess" valueReference="7" causality="calculatedParameter" variability="fixed" initial="approx">
    <Real unit="K" displayUnit="degC" start="300" min="0"/></ScalarVariable>
  <ScalarVariable name="pi" valueReference="8" variability="constant"><Real start="3.14"/></ScalarVariable>
  <ScalarVariable name="mode" valueReference="1" causality="input" variability="discrete">
    <Enumeration declaredType="Mode" start="3"/></ScalarVariable>
  <ScalarVariable name="on" valueReference="1" causality="output" variability="discrete">
    <Boolean declaredType="Flag"/></ScalarVariable>
  <ScalarVariable name="file" valueReference="1" causality="parameter" variability="fixed"><String start=""/>
  </ScalarVariable>
  <ScalarVariable name="count" valueReference="9" variability="discrete" initial="exact">
    <Integer start="0" min="0" max="9"/></ScalarVariable>
</ModelVariables>"""
_STRUCTURE = """<ModelStructure>
  <Outputs><Unknown index="12" dependencies="1 2" dependenciesKind="discrete discrete"/>
    <Unknown index="3" dependencies="3 7"/></Outputs>
  <Derivatives><Unknown index="5" dependencies="2 3" dependenciesKind="constant dependent"/></Derivatives>
  <InitialUnknowns><Unknown index="5" dependencies="3"/><Unknown index="8" dependencies="7"/><Unknown index="9"/>
    <Unknown index="12" dependencies=""/></InitialUnknowns>
</ModelStructure>"""


def make(good: Path, target: Path) -> Path:
    """The good FMU with this description; structured names but for one alias, so the convention is flat."""
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as sink:
        for name in source.namelist():
            data = source.read(name)
            sink.writestr(name, _described(data) if name == XML else data)
    return target


def _described(xml: bytes) -> bytes:
    root = etree.fromstring(xml)
    for part in (_UNITS, _VARIABLES, _STRUCTURE):
        new = etree.fromstring(part)
        root.replace(root.find(new.tag), new)
    root.find("UnitDefinitions").addnext(etree.fromstring(_DEFINITIONS))
    root.set("variableNamingConvention", "flat")
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8")
