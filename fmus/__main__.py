"""`python -m fmus`."""

from fmus.cli import main

main()
