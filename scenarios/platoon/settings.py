"""The settings of a platoon. Light to import."""

from cosim.scenario.settings import NumberSetting, Setting
from scenarios.formation.settings import formation_settings
from scenarios.platoon.events import MANOEUVRES
from scenarios.platoon.laws import HEADWAY, LAWS

SETTINGS = {
    **{name: s for name, s in formation_settings(10, "chain").items() if name != "frame"},
    "topology": Setting("chain", ("chain", "star"), "who follows whom: the car ahead, or all the head"),
    "headway": NumberSetting(HEADWAY, 0.0, 3.0, "s", "the wanted place moves back by this times the own speed"),
    "law": Setting("adaptive", tuple(LAWS), "how followers keep their places"),
    "manoeuvre": Setting("events", MANOEUVRES, "all events one after another, one of them, a sweep, or nothing"),
}
