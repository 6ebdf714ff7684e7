"""The keeper: a process between an owner and the foreign command it starts. It runs in a Python without any packages.

`__main__` is what it does, `fence` what it puts around it, `limits` and `processes` also serve the owner's side.
"""
