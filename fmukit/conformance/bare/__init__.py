"""What also runs in a Python without any packages (`python -I -S`), so it imports the standard library only.

To see whether an FMU lives on what it brings, an errand runs this very folder in such a Python: `__main__` is what it
does there, and `host` how it calls the FMU.
"""
