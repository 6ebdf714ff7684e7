"""Group X: the model description. One module per topic; the numbers of the rules follow the order of TOPICS."""

from importlib import import_module

TOPICS = ("description", "units", "types", "variables", "values", "structure")
for _topic in TOPICS:
    import_module(f"{__name__}.{_topic}")
