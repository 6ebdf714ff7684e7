"""The scenarios, by family: each folder names its scenarios in `__init__`, and holds their systems, metrics and picture.

They are found through the entry points of this project (see `cosim.scenario.discovery`).
"""
