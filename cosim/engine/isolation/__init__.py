"""Instances in processes of their own: what goes wrong inside one ends that process, and not the run's.

`proxy` is the slave that the master sees, `worker` the process that holds the FMU, `channel` what goes between them.
"""
