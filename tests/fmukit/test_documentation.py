"""What a user sees inside an FMU: complete, true to the model description, safe to open, the same at every build."""

from __future__ import annotations

import re
import struct
import zipfile
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import demo_spring
import matplotlib as mpl
import pytest

from fmukit.component import Component
from fmukit.packaging import pictures
from fmukit.packaging.cached import cached
from fmukit.packaging.documentation import documents
from fmukit.packaging.page import page
from fmukit.packaging.recording import record
from fmukit.packaging.sources import component_folder
from fmukit.reference_run import ReferenceRun, reference_run
from fmus import CATALOGUE
from fmus.sensors import imu
from fmus.sensors.imu import reference_run as imu_run

RUN = ReferenceRun("It swings.", stop=0.5, step=0.01, plots={"Position": ("position",), "Speed": ("speed",)})
every_component = pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)


class _Reader(HTMLParser):
    """Collects headings, table rows and links; fails on tags that are not closed."""

    VOID = ("img", "meta", "br", "hr")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.links: list[str] = []
        self.rows: list[list[str]] = []
        self.headings: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.links += [value or "" for key, value in attributes if key in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag in ("h1", "h2", "h3"):
            self.headings.append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data
        if {"h1", "h2", "h3"} & set(self.open):
            self.headings[-1] += data


def _members(component: Component) -> dict[str, bytes]:
    with zipfile.ZipFile(cached(component)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def _page(members: dict[str, bytes]) -> _Reader:
    return _Reader(members["documentation/index.html"].decode())


def _chunks(png: bytes) -> Iterator[str]:
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    offset = 8
    while offset < len(png):
        (length,) = struct.unpack_from(">I", png, offset)
        yield png[offset + 4 : offset + 8].decode()
        offset += 12 + length


@every_component
def test_fmu_holds_page_pictures_and_licences(component: Component) -> None:
    members = _members(component)
    needed = {"RecedingHorizonPlanner": b"casadi>=3.7\nnumpy>=2.0\n"}
    assert members["resources/requirements.txt"] == needed.get(component.interface.name, b"")
    for name in ("model.png", "documentation/reference_run.png"):
        assert set(_chunks(members[name])) <= {"IHDR", "pHYs", "IDAT", "IEND"}
    assert b"MIT" in members["documentation/licenses/vehicle-formation-fmus.txt"]
    assert b"Permission is hereby granted" in members["documentation/licenses/pythonfmu.txt"]
    for link in _page(members).links:
        place = str(Path("/documentation", link).resolve())[1:]
        assert any(name == place or name.startswith(f"{place}/") for name in members), link


@every_component
def test_page_has_every_heading_and_table_of_the_readme(component: Component) -> None:
    reader = _page(_members(component))
    text = (component_folder(component) / "README.md").read_text("utf-8")
    text = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    headings = [line.lstrip("# ").replace("`", "") for line in text.splitlines() if re.match("##+ ", line)]
    assert headings
    assert set(headings) <= set(reader.headings)
    tables = [line for line in text.splitlines() if re.match(r"\|[-| :]+\|$", line)]
    own = sum(row[0] != "name" and "what it is" not in row for row in reader.rows)
    assert own >= len(tables)
    assert "pre" in reader.tags


@every_component
def test_tables_agree_with_the_model_description(component: Component) -> None:
    members = _members(component)
    heads = [i for i, row in enumerate(_page(members).rows) if row[0] == "name" and "what it is" in row]
    rows = _page(members).rows
    listed = {}
    for start, end in zip(heads, [*heads[1:], len(rows)], strict=True):
        listed |= {row[0]: dict(zip(rows[start], row, strict=True)) for row in rows[start + 1 : end]}
    array = re.compile(r"\[\d+\]")
    names = set()
    for variable in ElementTree.fromstring(members["modelDescription.xml"]).iter("ScalarVariable"):
        name = variable.attrib["name"]
        same = [other for other in listed if array.sub("", name) == re.sub(r"\[\d+\.\.\d+\]", "", other)]
        assert len(same) == 1, name
        names.add(same[0])
        row, declared = listed[same[0]], variable[0].attrib
        assert row["unit"] == declared.get("unit", "1")
        if variable[0].tag == "Real" and "start" in declared:
            assert float(row["start"]) == pytest.approx(float(declared["start"]), rel=1e-9)
        if "min" in declared:
            assert float(row["range"].split(" … ")[0]) == pytest.approx(float(declared["min"]), rel=1e-5)
    assert names == set(listed)


def test_foreign_html_in_a_readme_is_shown_and_not_run() -> None:
    text = page(
        demo_spring.INTERFACE, "# Title\n<script>alert(1)</script>\n\n| a | b |\n|---|---|\n| x | y |\n", None, "1"
    )
    reader = _Reader(text)
    assert not {"script", "iframe", "object"} & reader.tags
    assert ["x", "y"] in reader.rows
    assert "What it computes" in reader.headings


def test_documents_do_not_depend_on_the_users_settings() -> None:
    component = demo_spring.COMPONENT
    recording = record(component, component.kernel(), RUN)
    first = documents(component, recording)
    with mpl.rc_context({"font.size": 31.0, "figure.dpi": 33.0, "axes.facecolor": "red", "savefig.dpi": 20.0}):
        assert documents(component, recording) == first
    assert len(first["documentation/reference_run.png"]) > 5000


def test_without_a_reference_run_there_is_no_plot() -> None:
    members = documents(demo_spring.COMPONENT, None)
    assert "documentation/reference_run.png" not in members
    assert _page(members).links == ["licenses/", "../model.png"]


def test_ports_are_grouped_by_family() -> None:
    names = ["force", "wheel.fl", "wheel.fr", "preview[1].x", "preview[1].y", "preview[2].x", "preview[2].y", "a.b"]
    assert pictures.families(names) == ["force", "wheel.{fl, fr}", "preview[1..2].{x, y}", "a.b"]
    many = [f"estimate.quantity_{i}" for i in range(9)]
    assert pictures.families(many) == ["estimate.* (9)"]


def test_mistakes_in_a_reference_run_name_the_panel(monkeypatch: pytest.MonkeyPatch) -> None:
    for plots, words in (
        ({"Nothing": ("force",)}, "panel 'Nothing' shows force, which is not an output"),
        ({"Mixed": ("accelerometer.x", "gyroscope.x")}, "panel 'Mixed' needs outputs of one unit"),
    ):
        monkeypatch.setattr(imu_run, "RUN", ReferenceRun("Wrong.", 1.0, 0.1, plots))
        with pytest.raises(ValueError, match=words):
            reference_run(imu.COMPONENT)
