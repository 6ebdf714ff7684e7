"""`fmus check`: is this FMI 2.0 co-simulation FMU sound? Rules in groups, each with its section of the standard.

A rule is one function that yields a sentence per thing it sees wrong (`rule`). Groups: A archive, X model description,
L life cycle, B behaviour, I isolation. The rules of A and X only read; those of L, B and I run the FMU in a process of
their own, so that one that crashes ends its rule and not the check.
"""
