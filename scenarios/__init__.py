"""The scenarios, by family: a folder for each, with its systems, its metrics and its picture.

The `__init__` of a family names its scenarios. They are found through the entry points of this project (see
`cosim.scenario.discovery`).
"""
