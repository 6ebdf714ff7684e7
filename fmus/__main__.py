"""`python -m fmus`."""

from fmus.command.main import main

main()
